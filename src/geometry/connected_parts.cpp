#include "geometry/connected_parts.h"

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <optional>
#include <span>

#include "base/union_find.h"
#include "floe/base/item.h"

namespace floe {

Shapes connected_parts(const Shapes& shapes, std::int32_t body) {
  const std::int32_t first = item(shapes.vertex_of, body), end = item(shapes.vertex_of, body + 1);
  UnionFind sets(static_cast<std::size_t>(end - first));
  const auto corners_of = [&](std::int32_t face) {
    const auto begin = static_cast<std::size_t>(item(shapes.corner_of, face));
    return std::span(shapes.corners)
        .subspan(begin, static_cast<std::size_t>(item(shapes.corner_of, face + 1)) - begin);
  };
  const std::int32_t begin = item(shapes.face_of, body), last = item(shapes.face_of, body + 1);
  for (std::int32_t f = begin; f < last; ++f)
    for (const std::int32_t c : corners_of(f)) sets.unite(c - first, corners_of(f)[0] - first);
  const std::vector<std::int32_t> set_of = sets.representatives();
  std::map<std::int32_t, std::vector<std::int32_t>> faces;  // by set; vertices without a face: none
  for (std::int32_t f = begin; f < last; ++f)
    faces[item(set_of, corners_of(f)[0] - first)].push_back(f);
  Shapes parts;
  for (const auto& [set, of_set] : faces) {
    std::map<std::int32_t, std::int32_t> number;  // of a vertex in `parts`
    for (std::int32_t v = first; v < end; ++v) {
      if (item(set_of, v - first) != set) continue;
      number[v] = static_cast<std::int32_t>(parts.vertices.size());
      parts.vertices.push_back(item(shapes.vertices, v));
    }
    for (const std::int32_t f : of_set) {
      for (const std::int32_t c : corners_of(f)) parts.corners.push_back(number.at(c));
      parts.corner_of.push_back(static_cast<std::int32_t>(parts.corners.size()));
    }
    parts.face_of.push_back(static_cast<std::int32_t>(parts.corner_of.size()) - 1);
    parts.vertex_of.push_back(static_cast<std::int32_t>(parts.vertices.size()));
  }
  return parts;
}

namespace {

using Range = std::array<double, 2>;

/// Returns the range of y of a convex polygon at x; nothing beside it.
std::optional<Range> range_at(const std::vector<Point2>& polygon, double x) {
  std::optional<Range> range;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Point2 &a = polygon[k], &b = polygon[(k + 1) % polygon.size()];
    if ((a[0] < x) == (b[0] < x)) continue;
    const double y = a[1] + (x - a[0]) / (b[0] - a[0]) * (b[1] - a[1]);
    range = range ? Range{std::min((*range)[0], y), std::max((*range)[1], y)} : Range{y, y};
  }
  return range;
}

}  // namespace

/// Between the x of all corners and crossings of edges the length of the union along y is linear in
/// x, so that its value in the middle times the width is its integral.
double area_of_union(const std::vector<std::vector<Point2>>& polygons) {
  std::vector<double> cuts;
  std::vector<std::array<Point2, 2>> edges;
  for (const auto& polygon : polygons) {
    for (std::size_t k = 0; k < polygon.size(); ++k) {
      cuts.push_back(polygon[k][0]);
      edges.push_back({polygon[k], polygon[(k + 1) % polygon.size()]});
    }
  }
  for (std::size_t i = 0; i < edges.size(); ++i) {
    for (std::size_t j = i + 1; j < edges.size(); ++j) {
      const auto& [a, b] = edges[i];
      const auto& [c, d] = edges[j];
      const double ux = b[0] - a[0], uy = b[1] - a[1], vx = d[0] - c[0], vy = d[1] - c[1];
      const double across = ux * vy - uy * vx;
      if (across == 0) continue;
      const double s = ((c[0] - a[0]) * vy - (c[1] - a[1]) * vx) / across;
      if (s > 0 && s < 1) cuts.push_back(a[0] + s * ux);
    }
  }
  std::sort(cuts.begin(), cuts.end());
  double area = 0;
  std::vector<Range> ranges;
  for (std::size_t k = 0; k + 1 < cuts.size(); ++k) {
    const double width = cuts[k + 1] - cuts[k];
    if (!(width > 0)) continue;
    ranges.clear();
    for (const auto& polygon : polygons)
      if (const auto range = range_at(polygon, 0.5 * (cuts[k] + cuts[k + 1])))
        ranges.push_back(*range);
    std::sort(ranges.begin(), ranges.end());
    double length = 0, until = -std::numeric_limits<double>::infinity();
    for (const auto& [low, high] : ranges) {
      length += std::max(0.0, high - std::max(low, until));
      until = std::max(until, high);
    }
    area += width * length;
  }
  return area;
}

}  // namespace floe
