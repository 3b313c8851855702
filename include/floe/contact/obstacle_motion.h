/// \file
/// How an obstacle moves: a function of time alone.
///
/// Notation: r ramp, R its integral, v velocity, w angular velocity, a amplitude, f frequency.
#pragma once

#include "floe/base/ramp.h"
#include "floe/base/rotation.h"

namespace floe {

/// Of the obstacle's frame: its origin goes R v + r a sin(2 pi f t), and it turns about its origin
/// by R w, an axis that keeps its direction. At rest unless something is given.
struct ObstacleMotion {
  Vec3<double> velocity{};          ///< after the ramp [m/s]
  Vec3<double> angular_velocity{};  ///< after the ramp [rad/s]
  Vec3<double> amplitude{};         ///< of the harmonic part, after the ramp [m]
  double frequency = 0;             ///< of the harmonic part [Hz]
  Ramp ramp{};

  Vec3<double> way(double time) const;   ///< of the origin since time 0 [m]
  Vec3<double> rate(double time) const;  ///< of the way [m/s], from the right
  Quat<double> turn(double time) const;  ///< since time 0
  Vec3<double> spin(double time) const;  ///< spatial [rad/s]

  bool at_rest() const;
  /// What no point within `radius` of the origin exceeds, ever [m/s].
  double largest_speed(double radius) const;
};

}  // namespace floe
