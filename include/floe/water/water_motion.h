/// \file
/// How the water moves besides its waves: one current and one level everywhere.
#pragma once

#include "floe/base/time_table.h"
#include "floe/geometry/polyhedron.h"

namespace floe {

/// Current and level of the water. Water rises with its level.
struct WaterMotion {
  Point3 current{};           ///< [m/s]
  TimeTable current_table{};  ///< of its x, y, z, in place of it; empty: none
  TimeTable level_table{};    ///< of its height over z = 0 [m]; empty: 0

  Point3 velocity(double time) const;      ///< with the rise of the level [m/s]
  Point3 acceleration(double time) const;  ///< of a smooth table [m/s^2]
  double level(double time) const { return level_table.empty() ? 0 : level_table.value(0, time); }
  double rise(double time) const { return level_table.empty() ? 0 : level_table.rate(0, time); }
};

}  // namespace floe
