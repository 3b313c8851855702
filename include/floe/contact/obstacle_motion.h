/// \file
/// The motion of an obstacle: a function of time alone.
///
/// Notation: r ramp, R its integral, v velocity, w angular velocity, a amplitude, f frequency.
#pragma once

#include <optional>

#include "floe/base/driven_motion.h"
#include "floe/base/motion_table.h"
#include "floe/base/ramp.h"
#include "floe/base/rotation.h"

namespace floe {

/// Motion of the frame of an obstacle: its origin is displaced by R v + r a sin(2 pi f t), and the
/// frame turns about its origin by R w, about an axis of fixed direction. Or a table says both: the
/// displacement, and the rotation vector. By default at rest.
struct ObstacleMotion {
  Vec3<double> velocity{};          ///< after the ramp [m/s]
  Vec3<double> angular_velocity{};  ///< after the ramp [rad/s]
  Vec3<double> amplitude{};         ///< of the harmonic part, after the ramp [m]
  double frequency = 0;             ///< of the harmonic part [Hz]
  Ramp ramp{};
  MotionTable table{};                   ///< in place of these; empty: none
  bool is_driven = false;                ///< whether a program may move it
  std::optional<DrivenMotion> driven{};  ///< in place of all others, once a program has

  Vec3<double> way(double time) const;   ///< displacement of the origin since time 0 [m]
  Vec3<double> rate(double time) const;  ///< velocity of the origin [m/s], from the right
  Quat<double> turn(double time) const;  ///< rotation since time 0
  Vec3<double> spin(double time) const;  ///< angular velocity in world axes [rad/s]

  /// Whether the obstacle never moves.
  bool at_rest() const;
  /// Upper bound, for all times, of the speed of points within `radius` [m] of the origin [m/s].
  double largest_speed(double radius) const;
};

}  // namespace floe
