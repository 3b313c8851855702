/// \file
/// Shapes put together.
#pragma once

#include "floe/geometry/polyhedron.h"

namespace floe {

/// Appends vertices, moved, and faces of all bodies of `shapes`; of which bodies they are is left
/// to the caller (Shapes::face_of, Shapes::vertex_of).
inline void append_faces(Shapes& to, const Shapes& shapes, const Point3& way = {}) {
  const auto first = static_cast<std::int32_t>(to.vertices.size());
  const auto corner = static_cast<std::int32_t>(to.corners.size());
  for (const Point3& r : shapes.vertices) to.vertices.push_back(r + way);
  for (const std::int32_t c : shapes.corners) to.corners.push_back(first + c);
  for (std::size_t f = 1; f < shapes.corner_of.size(); ++f)
    to.corner_of.push_back(corner + shapes.corner_of[f]);
}

/// Appends all bodies of `shapes`.
inline void append_bodies(Shapes& to, const Shapes& shapes) {
  const auto face = static_cast<std::int32_t>(to.corner_of.size()) - 1;
  const auto vertex = static_cast<std::int32_t>(to.vertices.size());
  append_faces(to, shapes);
  for (std::size_t b = 1; b < shapes.face_of.size(); ++b) {
    to.face_of.push_back(face + shapes.face_of[b]);
    to.vertex_of.push_back(vertex + shapes.vertex_of[b]);
  }
}

}  // namespace floe
