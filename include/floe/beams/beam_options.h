/// \file
/// Options of the beams of a lattice, as a scene states them (model.md, "Beam").
#pragma once

#include "floe/lattice/kinematics.h"

namespace floe {

/// Transverse stiffness k_s of a beam; the form of the energy is the same for all (model.md,
/// "Beam").
enum class Shear {
  one_point,  ///< kappa G A / l: linear Timoshenko element with one-point quadrature; the paper's
  exact,      ///< 12 E I / (l^3 (1 + Phi)): locking-free Timoshenko
  none,       ///< 12 E I / l^3: Euler-Bernoulli
};

/// Strains of a beam that have dashpots (model.md, "Explicit dynamics").
enum class DampingModes {
  all,    ///< all six
  axial,  ///< the elongation only
};

/// Options of all beams of a lattice.
struct BeamOptions {
  Shear shear = Shear::one_point;
  Kinematics kinematics = Kinematics::corotational;
  double damping_ratio = 0;  ///< zeta of each dashpot, c = 2 zeta sqrt(m_s k_s)
  DampingModes damping_modes = DampingModes::all;
};

}  // namespace floe
