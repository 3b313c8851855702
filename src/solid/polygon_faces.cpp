#include "solid/polygon_faces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include "floe/base/item.h"
#include "geometry/overlap.h"

namespace floe {
namespace {

using Loop = std::vector<std::int32_t>;

/// The faces of one hull.
class Faces {
 public:
  Faces(const Surface& hull, double rounding) : hull_(hull), rounding_(rounding) {
    for (const auto& [a, b, c] : hull.triangles)
      area_.push_back(cross(at(b) - at(a), at(c) - at(a)));
    for (std::int32_t t = 0; t < static_cast<std::int32_t>(hull.triangles.size()); ++t)
      for (std::size_t k = 0; k < 3; ++k) triangle_of_[{corner(t, k), corner(t, k + 1)}] = t;
  }

  /// Returns the loops of the faces; nothing if triangles of one face are no polygon.
  std::optional<std::vector<Loop>> loops() {
    group();
    std::vector<Loop> loops;
    for (std::int32_t f = 0; f < faces_; ++f) {
      auto loop = boundary(f);
      if (!loop) return {};
      loops.push_back(std::move(*loop));
    }
    leave_out_straight(loops);
    return loops;
  }

 private:
  const Point3& at(std::int32_t v) const { return item(hull_.vertices, v); }
  std::int32_t corner(std::int32_t t, std::size_t k) const {
    return item(hull_.triangles, t)[k % 3];
  }

  /// Gives each triangle its face: from the largest triangle on, those within rounding of its
  /// plane.
  void group() {
    const auto n = static_cast<std::int32_t>(hull_.triangles.size());
    std::vector<std::int32_t> order(hull_.triangles.size());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(), [&](std::int32_t s, std::int32_t t) {
      return dot(item(area_, s), item(area_, s)) > dot(item(area_, t), item(area_, t));
    });
    face_of_.assign(static_cast<std::size_t>(n), -1);
    for (const std::int32_t seed : order) {
      if (item(face_of_, seed) >= 0) continue;
      const double size = length(item(area_, seed));
      const Point3 normal = size > 0 ? (1 / size) * item(area_, seed) : Point3{};
      const double offset = dot(normal, at(corner(seed, 0)));
      std::vector<std::int32_t> todo{seed};
      item(face_of_, seed) = faces_;
      while (!todo.empty()) {
        const std::int32_t t = todo.back();
        todo.pop_back();
        for (std::size_t k = 0; k < 3; ++k) {
          const std::int32_t next = triangle_of_.at({corner(t, k + 1), corner(t, k)});
          if (item(face_of_, next) >= 0) continue;
          bool in_plane = true;
          for (const std::int32_t v : item(hull_.triangles, next))
            in_plane &= std::abs(dot(normal, at(v)) - offset) <= rounding_;
          if (!in_plane || dot(item(area_, next), normal) < 0) continue;
          item(face_of_, next) = faces_;
          todo.push_back(next);
        }
      }
      ++faces_;
    }
  }

  /// Returns the loop around a face; nothing if it is not a single one.
  std::optional<Loop> boundary(std::int32_t face) const {
    std::map<std::int32_t, std::int32_t> next;
    for (std::int32_t t = 0; t < static_cast<std::int32_t>(face_of_.size()); ++t) {
      if (item(face_of_, t) != face) continue;
      for (std::size_t k = 0; k < 3; ++k) {
        const std::int32_t a = corner(t, k), b = corner(t, k + 1);
        if (item(face_of_, triangle_of_.at({b, a})) == face) continue;
        if (!next.emplace(a, b).second) return {};
      }
    }
    if (next.size() < 3) return {};
    Loop loop;
    std::int32_t v = next.begin()->first;
    do {
      loop.push_back(v);
      const auto found = next.find(v);
      if (found == next.end()) return {};
      v = found->second;
    } while (v != loop.front() && loop.size() <= next.size());
    if (loop.size() != next.size()) return {};
    return loop;
  }

  /// Leaves out vertices between two faces only, on the line between their neighbours.
  void leave_out_straight(std::vector<Loop>& loops) const {
    std::map<std::int32_t, int> faces;
    for (const Loop& loop : loops)
      for (const std::int32_t v : loop) ++faces[v];
    for (const auto& [v, count] : faces) {
      if (count != 2) continue;
      bool straight = true;
      for (const Loop& loop : loops) {
        const auto found = std::find(loop.begin(), loop.end(), v);
        if (found == loop.end()) continue;
        const auto k = static_cast<std::size_t>(found - loop.begin());
        const Point3 a = at(loop[(k + loop.size() - 1) % loop.size()]);
        const Point3 b = at(loop[(k + 1) % loop.size()]);
        const Point3 along = b - a;
        const double size = length(along);
        straight &=
            loop.size() > 3 && size > 0 && length(cross(at(v) - a, along)) <= rounding_ * size;
      }
      if (!straight) continue;
      for (Loop& loop : loops) std::erase(loop, v);
    }
  }

  const Surface& hull_;
  double rounding_;
  std::vector<Point3> area_;  ///< twice the area vector of each triangle
  std::map<std::array<std::int32_t, 2>, std::int32_t> triangle_of_;  ///< of each directed edge
  std::vector<std::int32_t> face_of_;
  std::int32_t faces_ = 0;
};

Shapes polyhedron_of(const Surface& hull, const std::vector<Loop>& loops) {
  Shapes one;
  std::vector<std::int32_t> index(hull.vertices.size(), -1);
  for (const Loop& loop : loops) {
    for (const std::int32_t v : loop) {
      std::int32_t& to = item(index, v);
      if (to < 0) {
        to = static_cast<std::int32_t>(one.vertices.size());
        one.vertices.push_back(item(hull.vertices, v));
      }
      one.corners.push_back(to);
    }
    one.corner_of.push_back(static_cast<std::int32_t>(one.corners.size()));
  }
  one.face_of.push_back(static_cast<std::int32_t>(loops.size()));
  one.vertex_of.push_back(static_cast<std::int32_t>(one.vertices.size()));
  return one;
}

void append(Shapes& shapes, const Shapes& one) {
  const auto vertices = static_cast<std::int32_t>(shapes.vertices.size());
  const auto corners = static_cast<std::int32_t>(shapes.corners.size());
  const std::int32_t faces = shapes.face_of.back();
  shapes.vertices.insert(shapes.vertices.end(), one.vertices.begin(), one.vertices.end());
  for (const std::int32_t c : one.corners) shapes.corners.push_back(c + vertices);
  for (std::size_t f = 1; f < one.corner_of.size(); ++f)
    shapes.corner_of.push_back(one.corner_of[f] + corners);
  shapes.face_of.push_back(faces + one.face_of.back());
  shapes.vertex_of.push_back(static_cast<std::int32_t>(shapes.vertices.size()));
}

}  // namespace

void append_hull(Shapes& shapes, const Surface& hull, double rounding) {
  if (const auto loops = Faces(hull, rounding).loops()) {
    const Shapes one = polyhedron_of(hull, *loops);
    constexpr double some = 100;  // faces that share vertices share their deviations
    if (loops->size() >= 4 && !open_edge(one, 0) && concavity(one, 0) <= some * rounding)
      return append(shapes, one);
  }
  std::vector<Loop> triangles;
  for (const auto& [a, b, c] : hull.triangles) triangles.push_back({a, b, c});
  append(shapes, polyhedron_of(hull, triangles));
}

}  // namespace floe
