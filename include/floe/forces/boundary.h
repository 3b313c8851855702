/// \file
/// Prescribed motions, as a scene states them.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "floe/base/ramp.h"
#include "floe/geometry/polyhedron.h"

namespace floe {

/// Prescribed components of the motion of a set of bodies: x y z rx ry rz.
/// With `velocity`, displacements are its integral over the ramp; with `displacement`, they follow
/// the ramp. Rotations are integrals of `angular_velocity` in the same way.
struct Boundary {
  std::string name, set;
  std::array<bool, 6> fixed{};
  std::optional<Point3> displacement;  ///< [m]
  std::optional<Point3> velocity;      ///< [m/s]
  Point3 angular_velocity{};           ///< [rad/s]
  Ramp ramp;

  /// Prescribed displacement and rotation [m, rad] at `time`; entries that are not fixed are 0.
  std::array<double, 6> value(double time) const;
  /// Their rates [m/s, rad/s] and accelerations, from the right; what happens at once has none.
  std::array<double, 6> rate(double time) const;
  std::array<double, 6> acceleration(double time) const;
};

}  // namespace floe
