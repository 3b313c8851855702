#include "geometry/interface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "floe/base/item.h"
#include "geometry/across.h"
#include "geometry/separation.h"

namespace floe {
namespace {

/// A body by its placed vertices.
struct Placed {
  const Shapes& shapes;
  std::int32_t body;
  std::span<const Point3> vertices;

  std::int32_t first_face() const { return item(shapes.face_of, body); }
  std::int32_t end_face() const { return item(shapes.face_of, body + 1); }
  std::int32_t corners(std::int32_t face) const {
    return item(shapes.corner_of, face + 1) - item(shapes.corner_of, face);
  }
  const Point3& corner(std::int32_t face, std::int32_t k) const {
    const std::int32_t at = item(shapes.corners, item(shapes.corner_of, face) + k);
    return item(vertices, at - item(shapes.vertex_of, body));
  }
  /// Outward unit normal of a face (Newell's sum); 0 for a face without area.
  Vec3<double> normal(std::int32_t face) const {
    Vec3<double> sum{};
    const Point3 origin = corner(face, 0);
    const std::int32_t n = corners(face);
    for (std::int32_t k = 1; k + 1 < n; ++k)
      sum = sum + cross(corner(face, k) - origin, corner(face, k + 1) - origin);
    const double size = length(sum);
    return size > 0 ? (1 / size) * sum : sum;
  }
};

/// Directions of the edges, each once: parallel ones are left out.
std::vector<Vec3<double>> edges_of(const Placed& body) {
  constexpr double parallel = 1e-9;
  std::vector<Vec3<double>> found;
  for (std::int32_t f = body.first_face(); f < body.end_face(); ++f) {
    const std::int32_t n = body.corners(f);
    for (std::int32_t k = 0; k < n; ++k) {
      const Vec3<double> edge = body.corner(f, (k + 1) % n) - body.corner(f, k);
      const double size = length(edge);
      if (size == 0) continue;
      const Vec3<double> along = (1 / size) * edge;
      const bool known = std::any_of(found.begin(), found.end(), [&](const Vec3<double>& other) {
        return length(cross(other, along)) < parallel;
      });
      if (!known) found.push_back(along);
    }
  }
  return found;
}

/// The axis of the widest gap.
struct Widest {
  double gap = std::numeric_limits<double>::lowest();
  Vec3<double> normal{};
};

/// Faces come before edges, and an edge has to win by more than rounding: the planes of bodies that
/// lie face on face are then those of a face.
Widest widest_gap(const Placed& a, const Placed& b, double rounding) {
  Widest widest;
  const auto look = [&](const Vec3<double>& axis, double by) {
    const double gap = gap_along(b.vertices, a.vertices, axis);
    if (gap > widest.gap + by) widest = {gap, axis};
  };
  for (std::int32_t f = a.first_face(); f < a.end_face(); ++f) {
    if (const Vec3<double> n = a.normal(f); dot(n, n) > 0) look(n, rounding);
  }
  for (std::int32_t f = b.first_face(); f < b.end_face(); ++f) {
    if (const Vec3<double> n = b.normal(f); dot(n, n) > 0) look(-n, rounding);
  }
  const std::vector<Vec3<double>> edges = edges_of(b);
  for (const Vec3<double>& p : edges_of(a)) {
    for (const Vec3<double>& q : edges) {
      const Vec3<double> across = cross(p, q);
      const double size = length(across);
      constexpr double parallel = 1e-6;
      if (size < parallel) continue;
      const Vec3<double> axis = (1 / size) * across;
      look(axis, rounding), look(-axis, rounding);
    }
  }
  return widest;
}

using Polygon = std::vector<Point2>;

/// Leaves of a convex polygon the part where p . at >= least (Sutherland & Hodgman 1974).
void clip(Polygon& polygon, const Point2& p, double least, Polygon& room) {
  room.clear();
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Point2 &from = polygon[k], &to = polygon[(k + 1) % polygon.size()];
    const double s = p[0] * from[0] + p[1] * from[1] - least,
                 t = p[0] * to[0] + p[1] * to[1] - least;
    if (s >= 0) room.push_back(from);
    if ((s >= 0) == (t >= 0)) continue;
    const double at = s / (s - t);
    room.push_back({from[0] + at * (to[0] - from[0]), from[1] + at * (to[1] - from[1])});
  }
  std::swap(polygon, room);
}

/// A face seen along the normal: its outline counter-clockwise in the plane across, and its height
/// along the normal, h = at + slope . p.
struct Seen {
  Polygon outline;
  double at;
  Point2 slope;
};

/// The faces of a body that look along the normal (side = 1) or against it (side = -1).
std::vector<Seen> faces_seen(const Placed& body, double side, const Vec3<double>& normal,
                             const Vec3<double>& u, const Vec3<double>& v, const Point3& origin) {
  constexpr double edge_on = 1e-6;  // a face seen at a smaller sine has no area to speak of
  std::vector<Seen> seen;
  for (std::int32_t f = body.first_face(); f < body.end_face(); ++f) {
    const Vec3<double> n = body.normal(f);
    const double along = dot(n, normal);
    if (side * along < edge_on) continue;
    Seen face;
    const std::int32_t corners = body.corners(f);
    for (std::int32_t k = 0; k < corners; ++k) {
      const Point3 p = body.corner(f, k) - origin;
      face.outline.push_back({dot(p, u), dot(p, v)});
    }
    if (side < 0) std::reverse(face.outline.begin(), face.outline.end());
    // n . (p - c) = 0 with p = u, v and h along the normal.
    face.at = dot(n, body.corner(f, 0) - origin) / along;
    face.slope = {-dot(n, u) / along, -dot(n, v) / along};
    seen.push_back(std::move(face));
  }
  return seen;
}

/// Leaves of `polygon` what lies in a convex outline, counter-clockwise.
void clip_by(Polygon& polygon, const Polygon& outline, Polygon& room) {
  for (std::size_t k = 0; k < outline.size() && polygon.size() > 2; ++k) {
    const Point2 &from = outline[k], &to = outline[(k + 1) % outline.size()];
    const Point2 inward{from[1] - to[1], to[0] - from[0]};
    clip(polygon, inward, inward[0] * from[0] + inward[1] * from[1], room);
  }
}

/// Sums over plane areas, about the origin of the plane.
struct Sums {
  double area = 0, u = 0, v = 0, uu = 0, vv = 0, uv = 0, height = 0;

  /// \param at, slope  height at + slope . p
  void add(const Polygon& polygon, double at, const Point2& slope) {
    const PlanProperties p = plan_properties(polygon);
    if (!(p.area > 0)) return;
    const auto [cu, cv] = p.centroid;
    area += p.area;
    u += p.area * cu, v += p.area * cv;
    uu += p.xx + p.area * cu * cu, vv += p.yy + p.area * cv * cv, uv += p.xy + p.area * cu * cv;
    height += p.area * (at + slope[0] * cu + slope[1] * cv);
  }
};

}  // namespace

bool is_inside(const Shapes& shapes, std::int32_t body, std::span<const Point3> placed,
               const Point3& point, double by) {
  const Placed solid{shapes, body, placed};
  for (std::int32_t f = solid.first_face(); f < solid.end_face(); ++f) {
    if (dot(solid.normal(f), point - solid.corner(f, 0)) > by) return false;
  }
  return true;
}

std::optional<Interface> find_interface(const Shapes& shapes, std::int32_t a, std::int32_t b,
                                        std::span<const Point3> placed_a,
                                        std::span<const Point3> placed_b, double reach) {
  const Placed first{shapes, a, placed_a}, second{shapes, b, placed_b};
  const Point3 origin = placed_a[0];  // numbers as small as the bodies, wherever these lie
  double size = 0;
  for (const Point3& p : placed_a) size = std::max(size, length(p - origin));
  const Widest widest = widest_gap(first, second, 1e-9 * size);
  if (!(widest.gap <= reach)) return std::nullopt;
  const Vec3<double>& n = widest.normal;
  const auto [u, v] = basis_across(n);

  const std::vector<Seen> above = faces_seen(second, -1, n, u, v, origin);
  Sums sums;
  Polygon common, room;
  for (const Seen& lower : faces_seen(first, 1, n, u, v, origin)) {
    for (const Seen& upper : above) {
      common = lower.outline;
      clip_by(common, upper.outline, room);
      // upper - lower <= reach
      const Point2 slope{lower.slope[0] - upper.slope[0], lower.slope[1] - upper.slope[1]};
      if (common.size() > 2) clip(common, slope, upper.at - lower.at - reach, room);
      if (common.size() > 2)
        sums.add(common, (lower.at + upper.at) / 2,
                 {(lower.slope[0] + upper.slope[0]) / 2, (lower.slope[1] + upper.slope[1]) / 2});
    }
  }
  if (!(sums.area > 0)) return std::nullopt;
  const double cu = sums.u / sums.area, cv = sums.v / sums.area;
  const double uu = sums.uu - sums.area * cu * cu, vv = sums.vv - sums.area * cv * cv,
               uv = sums.uv - sums.area * cu * cv;
  const double mean = (uu + vv) / 2, half = std::hypot((uu - vv) / 2, uv);
  // Of a square or a circle the axes are rounding errors: the first of the plane's own is taken.
  const double turn = half > 1e-12 * mean ? std::atan2(2 * uv, uu - vv) / 2 : 0;
  return Interface{.gap = widest.gap,
                   .normal = n,
                   .area = sums.area,
                   .centre = origin + cu * u + cv * v + (sums.height / sums.area) * n,
                   .axis = std::cos(turn) * u + std::sin(turn) * v,
                   .most = mean + half,
                   .least = std::max(mean - half, 0.0)};
}

}  // namespace floe
