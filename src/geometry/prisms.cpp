#include <algorithm>

#include "floe/base/item.h"
#include "floe/geometry/polyhedron.h"

namespace floe {

void append_prism(Shapes& shapes, std::span<const Point2> polygon, double bottom, double top) {
  const auto n = static_cast<std::int32_t>(polygon.size());
  const auto base = shapes.vertex_of.back();
  for (const double z : {bottom, top}) {
    for (const Point2& p : polygon) shapes.vertices.push_back({p[0], p[1], z});
  }
  const auto close_face = [&] {
    shapes.corner_of.push_back(static_cast<std::int32_t>(shapes.corners.size()));
  };
  for (auto k = n - 1; k >= 0; --k) shapes.corners.push_back(base + k);  // bottom, seen from below
  close_face();
  for (std::int32_t k = 0; k < n; ++k) shapes.corners.push_back(base + n + k);
  close_face();
  for (std::int32_t k = 0; k < n; ++k) {
    const auto next = (k + 1) % n;
    for (const auto v : {k, next, n + next, n + k}) shapes.corners.push_back(base + v);
    close_face();
  }
  shapes.vertex_of.push_back(base + 2 * n);
  shapes.face_of.push_back(static_cast<std::int32_t>(shapes.corner_of.size()) - 1);
}

Shapes polyhedra(const Prisms& prisms) {
  const std::size_t n = prisms.corner_of.size() - 1, corners = prisms.corners.size();
  Shapes shapes;
  shapes.vertices.reserve(2 * corners);
  shapes.corners.reserve(6 * corners);
  shapes.corner_of.reserve(corners + 2 * n + 1);
  shapes.face_of.reserve(n + 1), shapes.vertex_of.reserve(n + 1);
  for (std::size_t b = 0; b < n; ++b) {
    const auto first = static_cast<std::size_t>(prisms.corner_of[b]),
               end = static_cast<std::size_t>(prisms.corner_of[b + 1]);
    append_prism(shapes, std::span(prisms.corners).subspan(first, end - first), prisms.bottom,
                 prisms.top);
  }
  return shapes;
}

std::optional<Prisms> as_prisms(const Shapes& shapes) {
  if (shapes.empty()) return {};
  Prisms prisms;
  prisms.bottom = shapes.vertices.front()[2];
  prisms.top = shapes.vertices[static_cast<std::size_t>(shapes.vertex_of[1]) - 1][2];
  Shapes one;  // the prism that body b must equal
  for (std::size_t b = 0; b < static_cast<std::size_t>(shapes.bodies()); ++b) {
    const auto first = static_cast<std::size_t>(shapes.vertex_of[b]),
               end = static_cast<std::size_t>(shapes.vertex_of[b + 1]);
    const std::size_t before = prisms.corners.size();
    for (std::size_t v = first; v < first + (end - first) / 2; ++v)
      prisms.corners.push_back({shapes.vertices[v][0], shapes.vertices[v][1]});
    prisms.corner_of.push_back(static_cast<std::int32_t>(prisms.corners.size()));

    one = {};
    append_prism(one, std::span(prisms.corners).subspan(before), prisms.bottom, prisms.top);
    const std::int32_t face = shapes.face_of[b], faces = shapes.face_of[b + 1] - face,
                       corner = item(shapes.corner_of, face);
    bool same = faces == one.face_of[1] && one.vertices.size() == end - first &&
                std::equal(one.vertices.begin(), one.vertices.end(),
                           shapes.vertices.begin() + static_cast<std::ptrdiff_t>(first));
    for (std::int32_t f = 0; same && f <= faces; ++f)
      same =
          shapes.corner_of[static_cast<std::size_t>(face) + static_cast<std::size_t>(f)] - corner ==
          item(one.corner_of, f);
    for (std::size_t c = 0; same && c < one.corners.size(); ++c)
      same = shapes.corners[static_cast<std::size_t>(corner) + c] - shapes.vertex_of[b] ==
             one.corners[c];
    if (!same) return {};
  }
  return prisms;
}

}  // namespace floe
