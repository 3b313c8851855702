/// \file
/// The parts of a body of several convex parts.
#pragma once

#include <vector>

#include "floe/geometry/polyhedron.h"

namespace floe {

/// Returns the number of parts of a body of polyhedra without holes, by Euler's formula: twice it
/// is vertices less edges plus faces.
inline std::int32_t number_of_parts(const Shapes& shapes, std::int32_t body) {
  const auto b = static_cast<std::size_t>(body);
  const std::int32_t begin = shapes.face_of[b], end = shapes.face_of[b + 1];
  const std::int32_t corners = shapes.corner_of[static_cast<std::size_t>(end)] -
                               shapes.corner_of[static_cast<std::size_t>(begin)];
  return (shapes.vertex_of[b + 1] - shapes.vertex_of[b] - corners / 2 + end - begin) / 2;
}

/// Returns the parts of a body, in its frame, as bodies of their own: the sets of faces that share
/// no vertices with others, in the order of their first vertices.
Shapes connected_parts(const Shapes& shapes, std::int32_t body);

/// Returns the area of the union of convex polygons in the plane [m^2].
/// \param polygons  counter-clockwise [m]
double area_of_union(const std::vector<std::vector<Point2>>& polygons);

}  // namespace floe
