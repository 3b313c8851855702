#include "floe/geometry/polyhedron.h"

#include <algorithm>

#include "floe/base/item.h"
#include "geometry/submerged.h"

namespace floe {

PlanProperties plan_properties(std::span<const Point2> polygon) {
  PlanProperties p;
  if (polygon.size() < 3) return p;
  // Green's theorem about the first vertex: the sums stay as small as the polygon, wherever the
  // polygon lies.
  const auto [x0, y0] = polygon[0];
  double area2 = 0, sx = 0, sy = 0, xx = 0, yy = 0, xy = 0;
  for (std::size_t k = 1; k + 1 < polygon.size(); ++k) {
    const double ax = polygon[k][0] - x0, ay = polygon[k][1] - y0;
    const double bx = polygon[k + 1][0] - x0, by = polygon[k + 1][1] - y0;
    const double c = ax * by - bx * ay;
    area2 += c;
    sx += c * (ax + bx);
    sy += c * (ay + by);
    xx += c * (ax * ax + ax * bx + bx * bx);
    yy += c * (ay * ay + ay * by + by * by);
    xy += c * (2 * (ax * ay + bx * by) + ax * by + bx * ay);
  }
  if (area2 == 0) return p;
  p.area = area2 / 2;
  const double cx = sx / (3 * area2), cy = sy / (3 * area2);
  p.centroid = {x0 + cx, y0 + cy};
  p.xx = xx / 12 - p.area * cx * cx;
  p.yy = yy / 12 - p.area * cy * cy;
  p.xy = xy / 24 - p.area * cx * cy;
  return p;
}

VolumeProperties volume_properties(const Shapes& shapes, std::int32_t body) {
  const Point3* vertex = shapes.vertices.data();
  const Point3 apex = vertex[shapes.vertex_of[body]];
  double volume6 = 0;
  Point3 first{};                  // 24 int r dV about the apex
  std::array<double, 6> second{};  // 120 int r r^T dV: xx yy zz xy xz yz
  for (auto f = shapes.face_of[body]; f < shapes.face_of[body + 1]; ++f) {
    const auto begin = shapes.corner_of[f], end = shapes.corner_of[f + 1];
    const Point3 a = vertex[shapes.corners[begin]] - apex;
    for (auto k = begin + 1; k + 1 < end; ++k) {
      const Point3 b = vertex[shapes.corners[k]] - apex;
      const Point3 c = vertex[shapes.corners[k + 1]] - apex;
      const double v = dot(a, cross(b, c));
      const Point3 s = a + b + c;
      // A tetrahedron with one vertex at the origin: 20 int r r^T dV = V (sum v v^T + s s^T).
      const auto moment = [&](int i, int j) {
        return v * (a[i] * a[j] + b[i] * b[j] + c[i] * c[j] + s[i] * s[j]);
      };
      volume6 += v;
      first = first + v * s;
      second[0] += moment(0, 0);
      second[1] += moment(1, 1);
      second[2] += moment(2, 2);
      second[3] += moment(0, 1);
      second[4] += moment(0, 2);
      second[5] += moment(1, 2);
    }
  }
  VolumeProperties p;
  if (volume6 == 0) return p;
  p.volume = volume6 / 6;
  const Point3 c{first[0] / (4 * volume6), first[1] / (4 * volume6), first[2] / (4 * volume6)};
  p.centroid = apex + c;
  const double xx = second[0] / 120 - p.volume * c[0] * c[0];
  const double yy = second[1] / 120 - p.volume * c[1] * c[1];
  const double zz = second[2] / 120 - p.volume * c[2] * c[2];
  const double xy = second[3] / 120 - p.volume * c[0] * c[1];
  const double xz = second[4] / 120 - p.volume * c[0] * c[2];
  const double yz = second[5] / 120 - p.volume * c[1] * c[2];
  p.inertia = {yy + zz, -xy, -xz, -xy, xx + zz, -yz, -xz, -yz, xx + yy};
  return p;
}

Submerged submerged(const Shapes& shapes, std::int32_t body, std::span<const Point3> placed,
                    double level) {
  return submerged_part(PlacedFaces{shapes, body, placed}, level);
}

std::optional<std::array<std::int32_t, 2>> open_edge(const Shapes& shapes, std::int32_t body) {
  using Edge = std::array<std::int32_t, 2>;
  std::vector<Edge> edges;
  const auto b = static_cast<std::size_t>(body);
  for (auto f = static_cast<std::size_t>(shapes.face_of[b]);
       f < static_cast<std::size_t>(shapes.face_of[b + 1]); ++f) {
    std::int32_t last = item(shapes.corners, shapes.corner_of[f + 1] - 1);
    for (auto c = static_cast<std::size_t>(shapes.corner_of[f]);
         c < static_cast<std::size_t>(shapes.corner_of[f + 1]); ++c) {
      const std::int32_t next = shapes.corners[c];
      if (next != last) edges.push_back({last, next});
      last = next;
    }
  }
  std::sort(edges.begin(), edges.end());
  if (const auto twice = std::adjacent_find(edges.begin(), edges.end()); twice != edges.end())
    return *twice;
  const auto alone = std::find_if(edges.begin(), edges.end(), [&](const Edge& e) {
    return !std::binary_search(edges.begin(), edges.end(), Edge{e[1], e[0]});
  });
  if (alone == edges.end()) return std::nullopt;
  return *alone;
}

}  // namespace floe
