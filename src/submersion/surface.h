/// \file
/// The water's surface and velocity around a body: a policy of the water's forces (model.md,
/// "Water"). A policy is a plain type with
///   static constexpr bool moves                     whether the surface differs between bodies
///   SurfacePlane plane(b, centroid, time)           the surface around body b
///   Vec3<double> velocity(b, centroid, time)        velocity of the water at body b [m/s]
/// so still water costs neither a branch nor a call.
#pragma once

#include <cmath>

#include "floe/lattice/state.h"
#include "floe/water/water_motion.h"

namespace floe {

/// The plane z = level + slope_x (x - x_G) + slope_y (y - y_G) of the water's surface around a body
/// with its centroid G over (x_G, y_G).
struct SurfacePlane {
  double level = 0;                 ///< [m]
  double slope_x = 0, slope_y = 0;  ///< of the surface

  /// Size of (-slope_x, -slope_y, 1).
  double steepness() const { return std::sqrt(1 + slope_x * slope_x + slope_y * slope_y); }
  /// Unit normal, up.
  Vec3<double> normal() const {
    const double upright = 1 / steepness();
    return {-slope_x * upright, -slope_y * upright, upright};
  }
  /// The shortest rotation that takes the normal to z.
  Quat<double> to_level() const {
    const Vec3<double> n = normal();
    return normalised(Quat<double>{1 + n.z, n.y, -n.x, 0});
  }
};

/// Water without waves: one current and one level everywhere.
struct StillWater {
  static constexpr bool moves = false;
  WaterMotion water;

  SurfacePlane plane(std::size_t, const Vec3<double>&, double time) const {
    return {.level = water.level(time)};
  }
  Vec3<double> velocity(std::size_t, const Vec3<double>&, double time) const {
    return water.velocity(time);
  }
};

}  // namespace floe
