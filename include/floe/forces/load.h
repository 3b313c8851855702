/// \file
/// Dead loads, as a scene states them.
#pragma once

#include <optional>
#include <string>

#include "floe/base/ramp.h"
#include "floe/geometry/polyhedron.h"

namespace floe {

/// A dead load in world axes: on a set (the total, shared equally by its bodies) or at a point in
/// plan (carried by the nearest body, statically equivalent: a force at a body-fixed point).
struct Load {
  std::string name;
  std::string set;              ///< empty: at a point
  std::optional<Point2> point;  ///< [m]
  Point3 force{};               ///< [N]
  Point3 moment{};              ///< [N m]
  Ramp ramp;
};

}  // namespace floe
