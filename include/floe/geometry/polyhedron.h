/// \file
/// Convex polyhedra: what a body looks like, and its mass properties.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace floe {

using Point2 = std::array<double, 2>;
using Point3 = std::array<double, 3>;

/// Area [m^2], centroid [m] and second moments about the centroid [m^4] of a simple polygon,
/// counter-clockwise: xx = int x^2 dA, yy = int y^2 dA, xy = int xy dA (Green's theorem).
struct PlanProperties {
  double area = 0;
  Point2 centroid{};
  double xx = 0, yy = 0, xy = 0;
};
PlanProperties plan_properties(std::span<const Point2> polygon);

/// Convex polyhedra of all bodies in one block, in each body's own frame (principal axes, origin at
/// the centroid). Body b has the faces face_of[b] ... face_of[b+1]-1; face f the vertices
/// corners[corner_of[f]]..., indices into `vertices`, counter-clockwise seen from outside.
struct Shapes {
  std::vector<Point3> vertices;
  std::vector<std::int32_t> corners;
  std::vector<std::int32_t> corner_of{0};
  std::vector<std::int32_t> face_of{0};
  std::vector<std::int32_t> vertex_of{0};  ///< body b's vertices: vertex_of[b] ... vertex_of[b+1]-1

  std::int32_t bodies() const { return static_cast<std::int32_t>(face_of.size()) - 1; }
  bool empty() const { return bodies() == 0; }
};

/// Appends the prism over a polygon, counter-clockwise in the body's frame, between two heights.
/// Vertices: the bottom's, then the top's; faces: bottom, top, sides.
void append_prism(Shapes& shapes, std::span<const Point2> polygon, double bottom, double top);

/// Prisms of one thickness by their plans: a quarter of the memory of their polyhedra.
struct Prisms {
  std::vector<Point2> corners;
  std::vector<std::int32_t> corner_of{0};  ///< body b's: corner_of[b] ... corner_of[b+1]-1
  double bottom = 0, top = 0;
};
/// Empty unless polyhedra() of the result gives exactly these shapes.
std::optional<Prisms> as_prisms(const Shapes& shapes);
Shapes polyhedra(const Prisms& prisms);

/// Volume [m^3], centroid [m] and the tensor of inertia per unit density about the centroid [m^5],
/// row-major, of body b of `shapes` (divergence theorem over its faces).
struct VolumeProperties {
  double volume = 0;
  Point3 centroid{};
  std::array<double, 9> inertia{};
};
VolumeProperties volume_properties(const Shapes& shapes, std::int32_t body);

/// An edge of a face of body b, from vertex to vertex, that no other face has in the other
/// direction, or that two have in the same; none if the faces close.
std::optional<std::array<std::int32_t, 2>> open_edge(const Shapes& shapes, std::int32_t body);

/// The part of a convex polyhedron below the plane z = level, after its vertices were placed in the
/// world. Waterplane moments are about the point (x0, y0) given to the function.
struct Submerged {
  double volume = 0;                 ///< [m^3]
  Point3 moment{};                   ///< int (r - x0) dV over the submerged part [m^4]
  double waterplane = 0;             ///< area of the cut [m^2]
  double wx = 0, wy = 0;             ///< int x, y dA over the cut [m^3]
  double wxx = 0, wxy = 0, wyy = 0;  ///< second moments of the cut [m^4]
};

/// A vertex at the level counts as dry: a body that rests on the surface has no waterplane, one
/// whose top face is awash has that face as its waterplane. \param placed  world coordinates of the
/// body's vertices, minus those of the reference point (x0, y0, z0) \param level   height of the
/// water above the reference point [m]
Submerged submerged(const Shapes& shapes, std::int32_t body, std::span<const Point3> placed,
                    double level);

}  // namespace floe
