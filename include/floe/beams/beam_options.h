/// \file
/// Which beams a lattice has (model.md section 2), as a scene states it.
#pragma once

#include "floe/lattice/kinematics.h"

namespace floe {

/// Transverse stiffness of a beam (model.md section 2): the same energy with a different k_s.
enum class Shear {
  one_point,  ///< kappa G A / l: linear Timoshenko element with one-point quadrature; the paper's
  exact,      ///< 12 E I / (l^3 (1 + Phi)): locking-free Timoshenko
  none,       ///< 12 E I / l^3: Euler-Bernoulli
};

enum class DampingModes {
  all,    ///< dashpots on all six strains
  axial,  ///< on the elongation only
};

struct BeamOptions {
  Shear shear = Shear::one_point;
  Kinematics kinematics = Kinematics::corotational;
  double damping_ratio = 0;  ///< zeta of each dashpot, c = 2 zeta sqrt(m_s k_s)
  DampingModes damping_modes = DampingModes::all;
};

}  // namespace floe
