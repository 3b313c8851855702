/// \file
/// Rigid obstacles: half-spaces, boxes, cones, cylinders, polyhedra and meshes from a file, and
/// what is put together from these. Each consists of one or several convex parts.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "floe/contact/obstacle_motion.h"
#include "floe/contact/surface_patch.h"
#include "floe/geometry/half_space.h"
#include "floe/geometry/polyhedron.h"

namespace floe {

/// Where a part meets another part of its obstacle: the common part of two of their faces.
struct InnerFace {
  std::int32_t other = 0;             ///< number of the other part
  std::vector<Vec3<double>> corners;  ///< of a convex polygon, in the frame of the obstacle [m]
};

/// A convex part of an obstacle, in the obstacle's frame. The parts of an obstacle do not overlap.
struct ConvexPart {
  std::vector<HalfSpace> planes;       ///< of its faces
  std::vector<Vec3<double>> vertices;  ///< [m]; none: a half-space
  std::vector<InnerFace> inner_faces;  ///< where it meets other parts
};

/// An obstacle. At time 0 its frame has the axes of the world and its origin at `point`; from then
/// on it follows `motion`. A half-space does not turn.
struct Obstacle {
  std::string name;
  Vec3<double> point{};  ///< origin of its frame at time 0 [m]
  ObstacleMotion motion;
  double friction = 0;                   ///< mu against bodies
  std::optional<double> friction_wet{};  ///< mu against bodies below still water, if another
  std::vector<ConvexPart> parts;         ///< at least one
  std::vector<SurfacePatch> patches;     ///< where its pressure is sampled; else none
  Shapes shape{};  ///< all faces of all parts as one body, in its frame; empty for a half-space
  /// The body of the model that carries it, of which the frame is this one's then; -1: it follows
  /// `motion`.
  std::int32_t body = -1;
  bool touches_obstacles = true;  ///< whether it touches others that are not ice
  bool is_ice = false;            ///< it is a body of the lattice that has several parts

  bool is_carried() const { return body >= 0; }
  bool is_half_space() const { return shape.empty(); }

  /// Distance of the farthest vertex from the origin of the frame [m].
  double radius() const;
};

/// Whether two obstacles touch each other: bodies carry both, or one, and not the same body.
inline bool may_touch(const Obstacle& one, const Obstacle& other) {
  return one.body != other.body &&
         (one.is_ice || other.is_ice || (one.touches_obstacles && other.touches_obstacles));
}

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
/// Returns the shapes of obstacles other than half-spaces, where they are at time 0.
std::vector<NamedShape> shapes_of(const std::vector<Obstacle>& obstacles);
/// The bodies of `shapes`, all in one frame, as the parts of an obstacle with the origin of its
/// frame at `point` [m].
Obstacle polyhedra(const Shapes& shapes, const Vec3<double>& point);
/// Returns the parts of an obstacle, which is not a half-space, as bodies of their own in its
/// frame.
Shapes shapes_of_parts(const Obstacle& obstacle);
/// Appends the parts of another obstacle, which is not a half-space, and finds all inner faces.
void add_parts(Obstacle& obstacle, const Obstacle& further);

/// Two parts of an obstacle that overlap.
struct PartsOverlap {
  std::int32_t one = 0, other = 0;  ///< numbers of the parts
  double volume = 0;                ///< of the overlap [m^3]
};
/// Returns two parts that overlap by more than 1e-9 of the smaller one's volume; nothing if none
/// do.
std::optional<PartsOverlap> overlap_of_parts(const Obstacle& obstacle);

}  // namespace floe
