/// \file
/// Rigid convex obstacles: half-spaces, boxes, cones, cylinders, polyhedra from a file.
#pragma once

#include <string>
#include <vector>

#include "floe/contact/obstacle_motion.h"
#include "floe/geometry/half_space.h"
#include "floe/geometry/polyhedron.h"

namespace floe {

/// Its frame is that of the world at time 0, moved to `point`; it goes on as `motion` says. A
/// half-space does not turn.
struct Obstacle {
  std::string name;
  Vec3<double> point{};  ///< origin of its frame at time 0 [m]
  ObstacleMotion motion;
  double friction = 0;  ///< mu against bodies
  std::vector<HalfSpace> planes;
  std::vector<Vec3<double>> vertices;  ///< empty: a half-space, which has none

  /// Distance of the farthest vertex from the origin of its frame [m].
  double radius() const;
};

/// \param normal  out of the obstacle, of any length but 0
Obstacle half_space(const Vec3<double>& point, const Vec3<double>& normal);
/// \param rotation  degrees about x, then y, then z
Obstacle box(const Vec3<double>& centre, const Vec3<double>& size, const Vec3<double>& rotation);
/// A frustum on a vertical axis with regular polygons of `facets` sides inside its two circles;
/// top_radius 0 makes a pyramid, radius = top_radius a cylinder. \param base  centre of the foot
Obstacle cone(const Vec3<double>& base, double radius, double top_radius, double height,
              int facets);
/// Body `body` of `shapes`, its frame moved to `point`.
Obstacle polyhedron(const Shapes& shapes, std::int32_t body, const Vec3<double>& point);

}  // namespace floe
