/// \file
/// Dead loads, as a scene states them.
#pragma once

#include <optional>
#include <string>

#include "floe/base/ramp.h"
#include "floe/base/time_table.h"
#include "floe/geometry/polyhedron.h"

namespace floe {

/// A dead load in world axes: a total that the bodies of a set share equally, or a load at a point
/// in plan. The body nearest to the point carries the latter as a statically equivalent force at a
/// body-fixed point.
struct Load {
  std::string name;
  std::string set;              ///< empty: the load is at `point`
  std::optional<Point2> point;  ///< x, y [m]
  Point3 force{};               ///< [N]
  Point3 moment{};              ///< [N m]
  Ramp ramp;
  /// In place of force, moment and ramp; empty: none.
  TimeTable table;  ///< its columns are the components of force and moment

  Point3 force_at(double time) const;   ///< [N]
  Point3 moment_at(double time) const;  ///< [N m]
};

}  // namespace floe
