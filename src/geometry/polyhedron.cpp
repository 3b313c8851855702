#include "floe/geometry/polyhedron.h"

#include <algorithm>

#include "floe/base/item.h"

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

namespace {

/// Sums of cones with one apex over triangles: six times the volume, and 24 times the first moment
/// about the apex.
struct Cones {
  Point3 apex;
  double volume6 = 0;
  Point3 moment24{};

  void add(const Point3& p, const Point3& q, const Point3& r) {
    const Point3 a = p - apex, b = q - apex, c = r - apex;
    const double v = dot(a, cross(b, c));
    volume6 += v;
    moment24 = moment24 + v * (a + b + c);
  }
};

}  // namespace

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
  Submerged s;
  bool any_below = false, any_above = false;
  for (const Point3& p : placed) (p[2] < level ? any_below : any_above) = true;
  if (!any_below) return s;

  // The apex of all cones lies in the plane of the water, so that the cut itself contributes
  // nothing and each face can be clipped on its own, without a list of its remaining parts. The
  // other two coordinates are the first vertex's, for small numbers.
  Cones cones{placed[0]};
  if (any_above) cones.apex[2] = level;
  const Point3& o = cones.apex;
  double cut2 = 0, sx = 0, sy = 0, xx = 0, yy = 0,
         xy = 0;  // Green's sums of the cut, about the apex

  const auto base = shapes.vertex_of[body];
  const auto corner = [&](std::int32_t k) -> const Point3& {
    return item(placed, shapes.corners[k] - base);
  };
  // Returns the point in which the edge from a (below) to b (not below) meets the plane. Both faces
  // of an edge get the same bits.
  const auto crossing = [level](const Point3& a, const Point3& b) {
    const double t = (level - a[2]) / (b[2] - a[2]);
    return Point3{a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]), level};
  };

  for (auto f = shapes.face_of[body]; f < shapes.face_of[body + 1]; ++f) {
    const auto begin = shapes.corner_of[f], end = shapes.corner_of[f + 1];
    Point3 first{}, previous{}, leaves{}, enters{};
    int emitted = 0;
    bool cut = false;
    const auto emit = [&](const Point3& p) {
      if (emitted == 0) first = p;
      if (emitted >= 2) cones.add(first, previous, p);
      previous = p;
      ++emitted;
    };
    for (auto k = begin; k < end; ++k) {
      const Point3& a = corner(k);
      const Point3& b = corner(k + 1 < end ? k + 1 : begin);
      const bool a_below = a[2] < level, b_below = b[2] < level;
      if (a_below) emit(a);
      if (a_below && !b_below) {
        leaves = crossing(a, b);
        cut = true;
        emit(leaves);
      } else if (!a_below && b_below) {
        enters = crossing(b, a);
        emit(enters);
      }
    }
    if (!cut) continue;
    // Seen from above, the part of the cut's boundary on this face runs against the face's
    // direction.
    const double ax = enters[0] - o[0], ay = enters[1] - o[1];
    const double bx = leaves[0] - o[0], by = leaves[1] - o[1];
    const double c = ax * by - bx * ay;
    cut2 += c;
    sx += c * (ax + bx);
    sy += c * (ay + by);
    xx += c * (ax * ax + ax * bx + bx * bx);
    yy += c * (ay * ay + ay * by + by * by);
    xy += c * (2 * (ax * ay + bx * by) + ax * by + bx * ay);
  }
  s.volume = cones.volume6 / 6;
  for (int i = 0; i < 3; ++i) s.moment[i] = cones.moment24[i] / 24 + s.volume * o[i];
  s.waterplane = cut2 / 2;
  const double lx = sx / 6, ly = sy / 6;  // first moments about the apex, then all about (0, 0)
  s.wx = lx + s.waterplane * o[0];
  s.wy = ly + s.waterplane * o[1];
  s.wxx = xx / 12 + 2 * o[0] * lx + s.waterplane * o[0] * o[0];
  s.wyy = yy / 12 + 2 * o[1] * ly + s.waterplane * o[1] * o[1];
  s.wxy = xy / 24 + o[0] * ly + o[1] * lx + s.waterplane * o[0] * o[1];
  return s;
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
