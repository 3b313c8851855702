/// \file
/// Calibrated sheets: stiffnesses of beams with which a large sheet has the constants of its
/// material (model.md, "Effective moduli of the lattice, calibrated sheets").
#pragma once

#include "floe/beams/moduli.h"

namespace floe {

/// Constants of the material that a large sheet gets by calibration.
enum class Calibrate {
  none,
  young,      ///< E: all stiffnesses times one number
  isotropic,  ///< E, nu, D and nu_b
};

/// Changes that calibration made to a sheet, and the moduli of a large calibrated sheet.
struct Calibration {
  LatticeRatios ratios;  ///< of the calibrated lattice, away from its edges
  double scale = 1;      ///< E of the beams over E of the material, away from the edges
  LatticeModuli moduli;  ///< expected of a large sheet
  /// Standard deviation of E*/E_b, nu*, D*/D and nu_b*, each a mean over directions, about `moduli`
  /// over meshes of as many bodies. It includes the inaccuracy of the formulas (measured for
  /// nu >= 0).
  struct {
    double young, poisson, bending, bending_poisson;
  } scatter{};
};

/// Largest Poisson's ratio that calibration can give to a lattice without negative stiffnesses.
inline constexpr double largest_isotropic_poisson = 1.0 / 3.0;

/// Changes young, shear_modulus, torsion and shear_factor_y of the beams of a sheet. The geometry
/// of the beams, from which stresses follow, stays.
/// \param lattice  with all of its beams (before cuts) and the sets left, right, bottom and top
/// \param ice      its poisson is at most largest_isotropic_poisson for `isotropic`
/// \param kind     young or isotropic
/// \param shear    transverse stiffness of the beams; one_point for `isotropic`
/// \throws InputError if all bodies lie on the sides of the sheet, since moduli are measured inside
Calibration calibrate(Lattice& lattice, const Ice& ice, Calibrate kind, Shear shear);

}  // namespace floe
