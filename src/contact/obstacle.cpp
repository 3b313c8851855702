#include "floe/contact/obstacle.h"

#include "geometry/overlap.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace floe {
namespace {

/// Appends a face. \param corners  counter-clockwise seen from outside
void add_face(Shapes& shapes, const std::vector<std::int32_t>& corners) {
  shapes.corners.insert(shapes.corners.end(), corners.begin(), corners.end());
  shapes.corner_of.push_back(static_cast<std::int32_t>(shapes.corners.size()));
}

void finish(Shapes& shapes) {
  shapes.face_of.push_back(static_cast<std::int32_t>(shapes.corner_of.size()) - 1);
  shapes.vertex_of.push_back(static_cast<std::int32_t>(shapes.vertices.size()));
}

/// The polyhedron between two polygons of equally many corners, the second above the first, or
/// between a polygon and an apex.
Shapes between(const std::vector<Point3>& low, const std::vector<Point3>& high) {
  Shapes s;
  s.vertices = low;
  s.vertices.insert(s.vertices.end(), high.begin(), high.end());
  const auto n = static_cast<std::int32_t>(low.size());
  const bool apex = high.size() == 1;
  std::vector<std::int32_t> floor, roof;
  for (std::int32_t k = 0; k < n; ++k) {
    floor.push_back(n - 1 - k);
    roof.push_back(n + k);
    const std::int32_t next = (k + 1) % n;
    add_face(s, apex ? std::vector{k, next, n} : std::vector{k, next, n + next, n + k});
  }
  add_face(s, floor);
  if (!apex) add_face(s, roof);
  finish(s);
  return s;
}

Shapes one_of(const Shapes& shapes, std::int32_t body) {
  const auto b = static_cast<std::size_t>(body);
  const std::int32_t first = shapes.vertex_of[b];
  Shapes one;
  one.vertices.assign(shapes.vertices.begin() + first,
                      shapes.vertices.begin() + shapes.vertex_of[b + 1]);
  for (std::int32_t f = shapes.face_of[b]; f < shapes.face_of[b + 1]; ++f) {
    std::vector<std::int32_t> corners;
    for (std::int32_t c = shapes.corner_of[static_cast<std::size_t>(f)];
         c < shapes.corner_of[static_cast<std::size_t>(f) + 1]; ++c)
      corners.push_back(shapes.corners[static_cast<std::size_t>(c)] - first);
    add_face(one, corners);
  }
  finish(one);
  return one;
}

}  // namespace

double Obstacle::radius() const {
  double most = 0;
  for (const Vec3<double>& r : vertices) most = std::max(most, dot(r, r));
  return std::sqrt(most);
}

Obstacle half_space(const Vec3<double>& point, const Vec3<double>& normal) {
  Obstacle o;
  o.point = point;
  o.planes = {{(1 / std::sqrt(dot(normal, normal))) * normal, 0}};
  return o;
}

Vec3<double> way_to_nearest(const std::vector<Obstacle>& obstacles, const Vec3<double>& from) {
  Vec3<double> shortest{};
  double least = std::numeric_limits<double>::infinity();
  for (const Obstacle& o : obstacles) {
    Vec3<double> way = o.point - from;
    if (o.vertices.empty()) way = dot(o.planes[0].normal, way) * o.planes[0].normal;
    const double distance = length(way);
    if (distance < least) least = distance, shortest = way;
  }
  return {shortest.x, shortest.y, 0};
}

Obstacle polyhedron(const Shapes& shapes, std::int32_t body, const Vec3<double>& point) {
  Obstacle o;
  o.point = point;
  append_half_spaces(shapes, body, o.planes);
  const auto b = static_cast<std::size_t>(body);
  for (auto v = static_cast<std::size_t>(shapes.vertex_of[b]);
       v < static_cast<std::size_t>(shapes.vertex_of[b + 1]); ++v)
    o.vertices.push_back(shapes.vertices[v]);
  o.shape = one_of(shapes, body);
  return o;
}

Obstacle box(const Vec3<double>& centre, const Vec3<double>& size, const Vec3<double>& rotation) {
  constexpr double degree = std::numbers::pi / 180;
  const Quat<double> q = product(exp_rotation({0, 0, degree * rotation.z}),
                                 product(exp_rotation({0, degree * rotation.y, 0}),
                                         exp_rotation({degree * rotation.x, 0, 0})));
  std::vector<Point3> low, high;
  for (const auto& [x, y] : {std::array{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}}) {
    for (const double z : {-0.5, 0.5}) {
      (z < 0 ? low : high).push_back(rotate(q, {x * size.x, y * size.y, z * size.z}));
    }
  }
  return polyhedron(between(low, high), 0, centre);
}

Obstacle cone(const Vec3<double>& base, double radius, double top_radius, double height,
              int facets) {
  std::vector<Point3> low, high;
  for (int k = 0; k < facets; ++k) {
    const double a = 2 * std::numbers::pi * (k + 0.5) / facets;  // one facet faces along x
    low.push_back({radius * std::cos(a), radius * std::sin(a), 0});
    if (top_radius > 0)
      high.push_back({top_radius * std::cos(a), top_radius * std::sin(a), height});
  }
  if (top_radius == 0) high.push_back({0, 0, height});
  return polyhedron(between(low, high), 0, base);
}

}  // namespace floe
