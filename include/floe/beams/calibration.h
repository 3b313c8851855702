/// \file
/// Calibrated sheets: stiffnesses of beams such that a large sheet has the material's own constants
/// (model.md section 3).
#pragma once

#include "floe/beams/moduli.h"

namespace floe {

enum class Calibrate {
  none,
  young,      ///< all stiffnesses times one number: a large sheet has the material's E
  isotropic,  ///< E, nu, D and nu_b of the material
};

/// What was done to a sheet, and what a large one of its kind has then.
struct Calibration {
  LatticeRatios ratios;  ///< of the calibrated lattice, away from its edges
  double scale = 1;      ///< E of the beams over the material's, away from the edges
  LatticeModuli moduli;  ///< expected of a large sheet
  /// Standard deviation of E*/E_b, nu*, D*/D and nu_b* about `moduli`, means over directions, over
  /// meshes of as many bodies; inaccuracies of the formulas included (measured for nu >= 0).
  struct {
    double young, poisson, bending, bending_poisson;
  } scatter{};
};

/// Largest Poisson's ratio that a lattice can be given without negative stiffnesses.
inline constexpr double largest_isotropic_poisson = 1.0 / 3.0;

/// Changes young, shear_modulus, torsion and shear_factor_y of a sheet's beams; their geometry,
/// from which stresses follow, stays. The lattice has all of its beams yet (before cuts), and the
/// sets left, right, bottom and top.
/// \param kind  young or isotropic   \param shear  the beams' transverse stiffness; one_point for
/// isotropic, and ice.poisson <= largest_isotropic_poisson
/// \throws InputError if all bodies lie on the sheet's sides: its inside cannot be measured.
Calibration calibrate(Lattice& lattice, const Ice& ice, Calibrate kind, Shear shear);

}  // namespace floe
