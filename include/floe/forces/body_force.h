/// \file
/// Forces of a program that uses floe as a library.
#pragma once

#include <cstdint>
#include <exception>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "floe/base/petsc.h"
#include "floe/base/rotation.h"

namespace floe {

/// The bodies of one rank, in the order of the lattice, at the start of a step; one entry each.
struct BodyArrays {
  double time = 0;                        ///< of the places [s]
  std::vector<std::int32_t> index;        ///< in the lattice
  std::vector<Vec3<double>> position;     ///< of the centroids [m]
  std::vector<Quat<double>> orientation;  ///< rotation since rest, w x y z
  std::vector<Vec3<double>> velocity;     ///< half a step before `time` [m/s]
  std::vector<Vec3<double>> spin;         ///< likewise, in world axes [rad/s]
  std::vector<double> mass;               ///< [kg]
  std::vector<Vec3<double>> force;        ///< to be set; zeros before [N]
  std::vector<Vec3<double>> moment;       ///< about the centroids; to be set; zeros before [N m]
};

/// A force on bodies in space, for explicit runs by leapfrog. It is asked once per step; no search
/// for the stable step sees that it changes, so it says how fast it does.
struct BodyForce {
  /// Sets force and moment. Called on all ranks alike, with the same object until bodies change
  /// ranks. An exception on one rank pauses the run before the step, on all ranks, with
  /// CallbackFailed.
  std::function<void(const std::shared_ptr<BodyArrays>& bodies)> set;
  double stiffness = 0;  ///< upper bound of M^-1 K [1/s^2]
  double damping = 0;    ///< upper bound of M^-1 C [1/s]
};

/// A function of the program has failed. The run pauses at the state before it, and may go on.
class CallbackFailed : public Verdict {
 public:
  explicit CallbackFailed(const std::string& what, std::exception_ptr why = nullptr)
      : Verdict(what), why_(std::move(why)) {}
  /// The exception of this rank; null if another rank had it.
  const std::exception_ptr& why() const { return why_; }

 private:
  std::exception_ptr why_;
};

}  // namespace floe
