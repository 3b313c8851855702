/// \file
/// The largest stable step of leapfrog with velocity-dependent forces (model.md, "Explicit
/// dynamics": Stable step).
#pragma once

#include <Eigen/Core>

#include <string>

#include "model/model.h"

namespace floe {

/// A stable step and the mode that limits it.
struct StableStep {
  double dt = 0;        ///< [s]
  double omega = 0;     ///< angular frequency of the limiting mode without damping [rad/s]
  double decay = 0;     ///< phi^T C phi of that mode (phi^T M phi = 1) [1/s]
  int evaluations = 0;  ///< number of evaluations of all forces in the search
  std::string limit;    ///< the body that moves most in that mode, and how
};

/// Finds the stable step of leapfrog. With velocities that lag half a step it is stable if and only
/// if 4M - 2 dt C - dt^2 K is positive definite. The search is for the dt at which the largest
/// eigenvalue of M^-1 (dt^2 K + 2 dt C) is 4, by a locally optimal conjugate gradient iteration
/// (Knyazev 2001) that solves for dt in the three-dimensional trial space of each iteration; dt
/// falls towards the limit. K and C act through differences of the forces at the given state, so
/// all forces count. Dashpots that act on velocities at t_n (LimitsStep::Rates) hold for dt C < 2
/// beside that. Collective.
template <class Space>
StableStep stable_step(const Model<Space>& model, const State<Space>& state);

/// Weights of a stiffness [1/s^2] and a damping [1/s], both per mass.
struct Weights {
  double stiffness = 0, damping = 0;
};

/// A mode phi of vibration, scaled to phi^T M phi = 1.
struct VibrationMode {
  double value = 0;  ///< the eigenvalue
  /// phi^T K phi [1/s^2] and phi^T C phi [1/s].
  double stiffness = 0, damping = 0;
  int evaluations = 0;    ///< number of evaluations of all forces in the search
  std::string where;      ///< the body that moves most in the mode, and how
  Eigen::VectorXd shape;  ///< M^1/2 phi, this rank's share
};

/// Finds the mode of the largest eigenvalue of M^-1 (w_k K + w_c C) by the same iteration, until
/// the eigenvalue changes by less than 1e-6 of it, or of 1e-3 if that is larger. Collective.
/// \param start  mode from which the search starts; null: a random vector
VibrationMode extreme_mode(const Model<Spatial>& model, const State<Spatial>& state,
                           const Weights& weights, const VibrationMode* start = nullptr);

}  // namespace floe
