/// \file
/// Effective moduli of large sheets of a lattice (model.md section 3): in closed form for the
/// infinite regular (triangular) one, with a measured correction for cells of any shape.
#pragma once

#include <complex>

#include "floe/beams/beam_options.h"
#include "floe/lattice/lattice.h"
#include "floe/lattice/material.h"

namespace floe {

/// In-plane moduli of a lattice and its plate bending stiffness, in units of the material's.
struct LatticeModuli {
  double young;    ///< E*/E_b; regular: 2(1+r)/(3+r)
  double poisson;  ///< nu*; regular: (1-r)/(3+r)
  double shear;    ///< G*/E_b; regular: (1+r)/4
  double bulk;     ///< K*/E_b = 1/2 (two-dimensional, plane stress)
  double bending;  ///< D*/D with D = E_b h^3/(12(1-nu^2)); regular: D* = sqrt(3)/(4l) (3EI_y + GJ)
  double bending_poisson;  ///< nu_b*; regular: (1-g)/(3+g)
};

/// What the moduli of a lattice of cells depend on. Means weigh each beam by its part of the plan.
struct LatticeRatios {
  double shear = 0;              ///< r: mean of k_sz/k_n
  double torsion = 0;            ///< g: mean of k_t/k_by
  double transverse = 0;         ///< rho: k_sy l^2/(4 k_by)
  double irregularity = 0;       ///< chi of the cells, 0 for regular hexagons (model.md section 3)
  std::complex<double> texture;  ///< p: mean of exp(4i phi) over the beams' directions
};

/// Of a sheet's lattice; bodies in its sets left, right, bottom and top are left out, as long as
/// there are others.
LatticeRatios lattice_ratios(const Lattice& lattice, Shear shear);

/// G*/E_b in the plane of beams with k_n = E_b A/l; S = D*(1-nu_b*) 12/(2 E_b h^3) of plates of
/// beams with k_by = E_b I_y/l. Both are what the corrections for irregular cells act on; the two
/// others, K* and D*(1+nu_b*), do not depend on the cells.
double in_plane_stiffness(double r, double irregularity, Shear shear);
double twist_stiffness(double g, double transverse, double irregularity);

/// Moduli of a large sheet of beams whose E_b I_y and E_b A are the material's.
LatticeModuli lattice_moduli(const LatticeRatios& ratios, double poisson, Shear shear);

/// Of the infinite regular lattice.
/// \param size  element size l [m]   \param thickness  h [m]
/// With w = l/sqrt(3), r = k_s/k_n (Ostoja-Starzewski 2002; Karihaloo, Shao & Xiao 2003).
LatticeModuli lattice_moduli(double size, double thickness, const Ice& ice, double shear_factor,
                             Shear shear, Torsion torsion);

}  // namespace floe
