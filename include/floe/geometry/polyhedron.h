/// \file
/// Convex polyhedra, the shapes of bodies, and their mass properties.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "floe/base/rotation.h"

namespace floe {

using Point2 = std::array<double, 2>;
using Point3 = Vec3<double>;

/// Area [m^2], centroid [m] and second moments about the centroid [m^4] of a simple polygon,
/// counter-clockwise: xx = int x^2 dA, yy = int y^2 dA, xy = int xy dA (Green's theorem).
struct PlanProperties {
  double area = 0;
  Point2 centroid{};
  double xx = 0, yy = 0, xy = 0;
};
PlanProperties plan_properties(std::span<const Point2> polygon);

/// The convex polyhedra of all bodies in one block, in each body's own frame (principal axes,
/// origin at the centroid). Body b has the faces face_of[b] ... face_of[b+1]-1; face f has the
/// corners corner_of[f] ... corner_of[f+1]-1 of `corners`, indices into `vertices`,
/// counter-clockwise seen from outside.
struct Shapes {
  std::vector<Point3> vertices;
  std::vector<std::int32_t> corners;
  std::vector<std::int32_t> corner_of{0};
  std::vector<std::int32_t> face_of{0};
  /// body b has the vertices vertex_of[b] ... vertex_of[b+1]-1
  std::vector<std::int32_t> vertex_of{0};

  std::int32_t bodies() const { return static_cast<std::int32_t>(face_of.size()) - 1; }
  bool empty() const { return bodies() == 0; }
};

/// A shape beside the bodies, at rest, as one body of `shape` in world axes.
struct NamedShape {
  std::string name;
  Shapes shape;
  std::vector<Point3> patch_centres, patch_normals;  ///< of patches of its surface, if any [m]
  std::vector<double> patch_areas;                   ///< [m^2]
  std::vector<double> patch_sizes;  ///< two of each patch: level, and up its plane [m]
};

/// Appends the prism over a polygon between two heights. The vertices of the bottom come first,
/// then those of the top; the faces are bottom, top, sides.
/// \param polygon  counter-clockwise in the body's frame [m]
/// \param bottom, top  heights in the body's frame [m]
void append_prism(Shapes& shapes, std::span<const Point2> polygon, double bottom, double top);

/// Prisms of one thickness by their plans, in a quarter of the memory of their polyhedra.
struct Prisms {
  std::vector<Point2> corners;
  std::vector<std::int32_t> corner_of{0};  ///< body b has corner_of[b] ... corner_of[b+1]-1
  double bottom = 0, top = 0;
};
/// Returns the prisms whose polyhedra() equal `shapes` exactly; nothing if there are none.
std::optional<Prisms> as_prisms(const Shapes& shapes);
/// Returns the polyhedra of the prisms, built by append_prism().
Shapes polyhedra(const Prisms& prisms);

/// Volume [m^3], centroid [m] and tensor of inertia per unit density about the centroid [m^5],
/// row-major, of one body of `shapes` (divergence theorem over its faces).
struct VolumeProperties {
  double volume = 0;
  Point3 centroid{};
  std::array<double, 9> inertia{};
};
VolumeProperties volume_properties(const Shapes& shapes, std::int32_t body);

/// Returns an edge of a face, as vertex to vertex, that no other face has in the other direction,
/// or that two faces have in the same direction; nothing if the faces of the body close.
std::optional<std::array<std::int32_t, 2>> open_edge(const Shapes& shapes, std::int32_t body);

/// The part of a convex polyhedron below the plane z = level, in coordinates relative to the
/// reference point (x0, y0, z0) of submerged().
struct Submerged {
  double volume = 0;                 ///< [m^3]
  Point3 moment{};                   ///< int r dV over the submerged part [m^4]
  double waterplane = 0;             ///< area of the cut with the plane [m^2]
  double wx = 0, wy = 0;             ///< int x dA, int y dA over the cut [m^3]
  double wxx = 0, wxy = 0, wyy = 0;  ///< second moments of the cut [m^4]
};

/// Returns the submerged part of a body. A vertex at the level counts as dry: a body that rests on
/// the surface has no waterplane, and a body whose top face is awash has that face as its
/// waterplane.
/// \param placed  world coordinates of the body's vertices minus those of a reference point (x0,
/// y0, z0) [m]
/// \param level  height of the water above the reference point [m]
Submerged submerged(const Shapes& shapes, std::int32_t body, std::span<const Point3> placed,
                    double level);

}  // namespace floe
