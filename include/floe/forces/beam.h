/// \file
/// What a scene says of its beams; the force itself is in src/forces/beam.cpp, its kernel in beam_kernel.h.
#pragma once

namespace floe {

/// Transverse stiffness of a beam (physics.md section 2): the same energy with a different k_s.
enum class Shear {
  one_point,  ///< kappa G A / l: linear Timoshenko element with one-point quadrature; the paper's
  exact,      ///< 12 E I / (l^3 (1 + Phi)): locking-free Timoshenko
  none,       ///< 12 E I / l^3: Euler-Bernoulli
};

enum class Kinematics {
  corotational,  ///< any rotation (Crisfield 1990, 1997)
  linear,        ///< small displacements and rotations: strains are linear in the unknowns
};

struct BeamOptions {
  Shear shear = Shear::one_point;
  Kinematics kinematics = Kinematics::corotational;
};

}  // namespace floe
