/// \file
/// Motions that a program gives piece by piece.
#pragma once

#include "floe/base/rotation.h"

namespace floe {

/// A motion that a program gives piece by piece. From `from` to `until` the displacement is the
/// cubic with the values and rates of both ends; the rotation is exp(r) q(from) with the cubic r
/// likewise, of which the end is less than half a turn away. Before and after the motion goes on
/// with the rates of the ends.
struct DrivenMotion {
  struct Place {
    Vec3<double> way{};             ///< displacement of the origin since time 0 [m]
    Quat<double> turn{1, 0, 0, 0};  ///< rotation since time 0
    Vec3<double> rate{};            ///< [m/s]
    Vec3<double> spin{};            ///< world axes [rad/s]
  };
  double from = 0, until = 0;  ///< [s]; equal: `end` holds at all times
  Place start, end;

  Place at(double time) const;
  /// Upper bound, for all times, of the speed of points within `radius` [m] of the origin [m/s].
  double largest_speed(double radius) const;
};

}  // namespace floe
