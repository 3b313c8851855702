/// \file
/// The largest stable step of leapfrog with velocity-dependent forces (model.md section 8,
/// "Stable step").
#pragma once

#include <Eigen/Core>

#include <string>

#include "model/model.h"

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
template <class Space>
StableStep stable_step(const Model<Space>& model, const State<Space>& state);

/// Of a stiffness [1/s^2] and a damping [1/s], both per mass.
struct Weights {
  double stiffness = 0, damping = 0;
};

struct VibrationMode {
  double value = 0;  ///< the eigenvalue
  double stiffness = 0,
         damping = 0;     ///< phi^T K phi [1/s^2] and phi^T C phi [1/s], phi^T M phi = 1
  int evaluations = 0;    ///< of all forces, to find it
  std::string where;      ///< the body that moves most in it, and how
  Eigen::VectorXd shape;  ///< M^1/2 phi, this rank's share
};

/// Mode of the largest eigenvalue of M^-1 (w_k K + w_c C), by the same iteration to 1e-6 of it, or
/// of 1e-3 if that is larger. \param start  where to search from; null: anywhere. Collective.
VibrationMode extreme_mode(const Model<Spatial>& model, const State<Spatial>& state,
                           const Weights& weights, const VibrationMode* start = nullptr);

}  // namespace floe
