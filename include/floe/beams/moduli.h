/// \file
/// Effective moduli of a large sheet: in closed form for the infinite regular (triangular) lattice,
/// with a measured correction for cells of any shape (model.md, "Effective moduli of the lattice,
/// calibrated sheets").
#pragma once

#include <complex>

#include "floe/beams/beam_options.h"
#include "floe/lattice/lattice.h"
#include "floe/lattice/material.h"

namespace floe {

/// Moduli of a lattice in its plane and in bending, relative to those of its material.
struct LatticeModuli {
  double young;    ///< E*/E_b; regular: 2(1+r)/(3+r)
  double poisson;  ///< nu*; regular: (1-r)/(3+r)
  double shear;    ///< G*/E_b; regular: (1+r)/4
  double bulk;     ///< K*/E_b = 1/2 (two-dimensional, plane stress)
  double bending;  ///< D*/D with D = E_b h^3/(12(1-nu^2)); regular: D* = sqrt(3)/(4l) (3EI_y + GJ)
  double bending_poisson;  ///< nu_b*; regular: (1-g)/(3+g)
};

/// Ratios that determine the moduli of a lattice. Means weigh each beam by its part of the plan.
struct LatticeRatios {
  double shear = 0;              ///< r: mean of k_sz/k_n
  double torsion = 0;            ///< g: mean of k_t/k_by
  double transverse = 0;         ///< rho: k_sy l^2/(4 k_by)
  double irregularity = 0;       ///< chi of the cells, 0 for regular hexagons
  std::complex<double> texture;  ///< p: mean of exp(4i phi) over the directions of the beams
};

/// Ratios of the lattice of a sheet. Bodies in the sets left, right, bottom and top are left out;
/// without these sets all bodies count.
LatticeRatios lattice_ratios(const Lattice& lattice, Shear shear);

/// G*/E_b of a lattice of beams with k_n = E_b A/l, corrected for irregular cells. K* does not
/// depend on the cells.
/// \param r             ratio k_sz/k_n
/// \param irregularity  chi
double in_plane_stiffness(double r, double irregularity, Shear shear);
/// D*(1-nu_b*) 12/(2 E_b h^3) of a plate of beams with k_by = E_b I_y/l, corrected for irregular
/// cells. D*(1+nu_b*) does not depend on the cells.
/// \param g             ratio k_t/k_by
/// \param transverse    rho = k_sy l^2/(4 k_by)
/// \param irregularity  chi
double twist_stiffness(double g, double transverse, double irregularity);

/// Moduli of a large sheet of beams with the E_b I_y and E_b A of the material.
/// \param poisson  nu of the material
LatticeModuli lattice_moduli(const LatticeRatios& ratios, double poisson, Shear shear);

/// Moduli of the infinite regular lattice, with w = l/sqrt(3), r = k_s/k_n (Ostoja-Starzewski 2002;
/// Karihaloo, Shao & Xiao 2003).
/// \param size       element size l [m]
/// \param thickness  h [m]
LatticeModuli lattice_moduli(double size, double thickness, const Ice& ice, double shear_factor,
                             Shear shear, Torsion torsion);

}  // namespace floe
