/// \file
/// Rigid convex obstacles: half-spaces, boxes, cones, cylinders, polyhedra from a file.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "floe/contact/obstacle_motion.h"
#include "floe/geometry/half_space.h"
#include "floe/geometry/polyhedron.h"

namespace floe {

/// An obstacle. At time 0 its frame has the axes of the world and its origin at `point`; from then
/// on it follows `motion`. A half-space does not turn.
struct Obstacle {
  std::string name;
  Vec3<double> point{};  ///< origin of its frame at time 0 [m]
  ObstacleMotion motion;
  double friction = 0;                   ///< mu against bodies
  std::optional<double> friction_wet{};  ///< mu against bodies below still water, if another
  std::vector<HalfSpace> planes;         ///< of its faces, in its frame
  std::vector<Vec3<double>> vertices;    ///< in its frame [m]; empty for a half-space
  Shapes shape{};                        ///< the same with its faces; empty for a half-space
  /// The body of the model that carries it, of which the frame is this one's then; -1: it follows
  /// `motion`.
  std::int32_t body = -1;

  bool is_carried() const { return body >= 0; }

  /// Distance of the farthest vertex from the origin of the frame [m].
  double radius() const;
};

/// A half-space.
/// \param point   on its surface [m]
/// \param normal  out of the obstacle, of any length but 0
Obstacle half_space(const Vec3<double>& point, const Vec3<double>& normal);
/// A box.
/// \param centre    [m]
/// \param size      lengths of its sides [m]
/// \param rotation  degrees about x, then y, then z
Obstacle box(const Vec3<double>& centre, const Vec3<double>& size, const Vec3<double>& rotation);
/// A frustum on a vertical axis, with regular polygons inside its two circles; top_radius 0 makes a
/// pyramid, radius = top_radius a cylinder.
/// \param base                        centre of the foot [m]
/// \param radius, top_radius, height  [m]
/// \param facets                      number of sides of the polygons
Obstacle cone(const Vec3<double>& base, double radius, double top_radius, double height,
              int facets);
/// Returns the way in plan from a point to the nearest obstacle: to the origin of its frame, or
/// straight to a half-space [m]; zero without obstacles, and where the nearest is above or below.
Vec3<double> way_to_nearest(const std::vector<Obstacle>& obstacles, const Vec3<double>& from);
/// Body `body` of `shapes`, with the origin of its frame at `point` [m].
Obstacle polyhedron(const Shapes& shapes, std::int32_t body, const Vec3<double>& point);

}  // namespace floe
