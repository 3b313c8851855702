/// \file
/// Prescribed motions, as a scene states them.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

#include "floe/base/motion_table.h"
#include "floe/base/ramp.h"
#include "floe/geometry/polyhedron.h"

namespace floe {

/// Names of the components of a motion: displacements along the axes, rotations about them.
inline constexpr std::array<std::string_view, 6> component_names{"x", "y", "z", "rx", "ry", "rz"};

/// Prescribed components of the motion of a set of bodies, in the order of component_names.
/// Displacements are `displacement` times the ramp, or `velocity` times the integral of the ramp.
/// Rotations are `angular_velocity` times the integral of the ramp. Or a table says both; rates of
/// its rotations are angular velocities.
struct Boundary {
  std::string name, set;
  std::array<bool, 6> fixed{};
  std::optional<Point3> displacement;  ///< [m]
  std::optional<Point3> velocity;      ///< [m/s]
  Point3 angular_velocity{};           ///< [rad/s]
  Ramp ramp;
  MotionTable table;  ///< in place of these; empty: none

  /// Prescribed displacement and rotation [m, rad] at `time` [s]; entries that are not fixed are 0.
  std::array<double, 6> value(double time) const;
  /// Rate of value() [m/s, rad/s], from the right. A jump (ramp of 0 s) has no rate.
  std::array<double, 6> rate(double time) const;
  /// Rate of rate() [m/s^2, rad/s^2], from the right. A jump of the velocity has no acceleration.
  std::array<double, 6> acceleration(double time) const;
};

}  // namespace floe
