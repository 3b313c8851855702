/// \file
/// The largest stable step of leapfrog with velocity-dependent forces (model.md section 8,
/// "Stable step").
#pragma once

#include <string>

#include "floe/solve/model.h"

namespace floe {

struct StableStep {
  double dt = 0;        ///< [s]
  double omega = 0;     ///< angular frequency of the mode that limits it, without damping [rad/s]
  double decay = 0;     ///< phi^T C phi of that mode (phi^T M phi = 1) [1/s]
  int evaluations = 0;  ///< of all forces, to find it
  std::string limit;    ///< where: the body that moves most in that mode, and how
};

/// Leapfrog whose velocities lag half a step is stable if and only if 4M - 2 dt C - dt^2 K is
/// positive definite. Finds the dt at which the largest eigenvalue of M^-1 (dt^2 K + 2 dt C) is 4,
/// by a locally optimal conjugate gradient iteration (Knyazev 2001) in which dt is solved for in
/// the three-dimensional trial space of each iteration; dt falls towards the limit. K and C act
/// through differences of the forces at the given state, so all forces count. Collective.
StableStep stable_step(const Model<Spatial>& model, const State<Spatial>& state);

}  // namespace floe
