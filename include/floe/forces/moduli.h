/// \file
/// Effective moduli of the infinite regular (triangular) lattice (model.md section 3).
#pragma once

#include "floe/forces/beam.h"
#include "floe/lattice/material.h"

namespace floe {

/// In-plane moduli of the lattice and its plate bending stiffness, in units of the beams' own.
struct LatticeModuli {
  double young;    ///< E*/E_b = 2(1+r)/(3+r)
  double poisson;  ///< nu* = (1-r)/(3+r)
  double shear;    ///< G*/E_b = (1+r)/4
  double bulk;     ///< K*/E_b = 1/2 (two-dimensional, plane stress)
  double bending;  ///< D*/D with D = E_b h^3/(12(1-nu^2)), D* = sqrt(3)/(4l) (3 E I_y + G J)
  double bending_poisson;  ///< nu_b* = (1-g)/(3+g), g = GJ/EI_y
};

/// \param size  element size l [m]   \param thickness  h [m]
/// With w = l/sqrt(3), r = k_s/k_n (Ostoja-Starzewski 2002; Karihaloo, Shao & Xiao 2003).
LatticeModuli lattice_moduli(double size, double thickness, const Ice& ice, double shear_factor,
                             Shear shear, Torsion torsion);

}  // namespace floe
