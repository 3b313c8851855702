/// \file
/// What of solids needs CGAL: hulls, triangulations and crossings, by exact predicates. Results
/// depend on the arguments only, not on the processor.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "floe/geometry/polyhedron.h"
#include "solid/surface.h"

namespace floe {

/// Returns the convex hull of points: its triangles, counter-clockwise seen from outside, and its
/// vertices, which are the corners among the points, sorted by coordinates. Empty if all points lie
/// in one plane.
Surface convex_hull(std::span<const Point3> points);

/// Triangles and how many times each counts: 1, or -1 and 2 by rounding along edges.
struct Filling {
  std::vector<Surface::Triangle> triangles;  ///< counter-clockwise, indices of points
  std::vector<int> times;
};

/// Returns triangles whose boundary is the given edges: of each point of the plane, the number of
/// times that the edges wind around it.
/// \param points  the distinct ends of edges
/// \param edges   from point to point, with the region on their left; closed loops altogether
/// \return nothing if edges cross, or a point lies on an edge that does not end there
std::optional<Filling> fill(std::span<const Point2> points,
                            std::span<const std::array<std::int32_t, 2>> edges);

/// Returns the first two triangles, by their indices, that intersect or touch but at common edges
/// and vertices; nothing if there are none.
std::optional<std::array<std::int32_t, 2>> crossing_triangles(const Surface& surface);

}  // namespace floe
