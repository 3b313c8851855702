#include "floe/contact/obstacle.h"

#include "floe/base/item.h"

#include "contact/part_faces.h"
#include "geometry/append_faces.h"
#include "geometry/convex_polygon.h"
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

double size_of(const Obstacle& obstacle) {
  double most = 0;
  for (const ConvexPart& part : obstacle.parts)
    for (const Vec3<double>& r : part.vertices) most = std::max(most, length(r));
  return most;
}

/// Returns what two faces have in common. \param face  of one part
/// \param plane  of the other part, in which the face lies
std::vector<Vec3<double>> common(std::vector<Vec3<double>> face, const ConvexPart& other,
                                 const HalfSpace& plane, double near) {
  std::vector<Vec3<double>> work;
  for (const HalfSpace& bound : other.planes) {
    if (length(bound.normal - plane.normal) > 1e-6) cut(face, bound, work);
    if (face.size() < 3) return {};
  }
  const Vec3<double> apart = face[2] - face[0];
  if (length(area_vector(face)) <= near * std::max(length(face[1] - face[0]), length(apart)))
    return {};
  return face;
}

/// Finds where two parts meet.
void find_inner_faces(Obstacle& obstacle, std::size_t i, std::size_t j, double near) {
  ConvexPart &one = obstacle.parts[i], &other = obstacle.parts[j];
  for (const HalfSpace& plane : different_planes(one, near)) {
    const HalfSpace opposite{-1.0 * plane.normal, -plane.offset};
    const bool meets = std::any_of(other.planes.begin(), other.planes.end(),
                                   [&](const HalfSpace& p) { return is_same(p, opposite, near); });
    if (!meets) continue;
    const auto face = common(face_in(one, plane, near), other, opposite, near);
    if (face.empty()) continue;
    one.inner_faces.push_back({.other = static_cast<std::int32_t>(j), .corners = face});
    other.inner_faces.push_back(
        {.other = static_cast<std::int32_t>(i), .corners = {face.rbegin(), face.rend()}});
  }
}

/// Finds where all parts meet.
void find_inner_faces(Obstacle& obstacle) {
  const double near = 1e-9 * size_of(obstacle);
  std::vector<std::pair<Vec3<double>, double>> spheres;  // around parts
  for (ConvexPart& part : obstacle.parts) {
    part.inner_faces.clear();
    Vec3<double> middle{};
    for (const Vec3<double>& r : part.vertices) middle = middle + r;
    middle = (1 / static_cast<double>(part.vertices.size())) * middle;
    double radius = 0;
    for (const Vec3<double>& r : part.vertices) radius = std::max(radius, length(r - middle));
    spheres.emplace_back(middle, radius);
  }
  for (std::size_t i = 0; i < spheres.size(); ++i)
    for (std::size_t j = i + 1; j < spheres.size(); ++j)
      if (length(spheres[i].first - spheres[j].first) <
          spheres[i].second + spheres[j].second + near)
        find_inner_faces(obstacle, i, j, near);
}

/// Appends the faces of all bodies of `shapes`, moved, to the one body of `to`.
void append_to_body(Shapes& to, const Shapes& shapes, const Vec3<double>& way) {
  append_faces(to, shapes, way);
  to.face_of = {0, static_cast<std::int32_t>(to.corner_of.size()) - 1};
  to.vertex_of = {0, static_cast<std::int32_t>(to.vertices.size())};
}

}  // namespace

Shapes shapes_of_parts(const Obstacle& obstacle) {
  Shapes shapes = obstacle.shape;
  shapes.face_of = {0};
  shapes.vertex_of = {0};
  std::int32_t vertices = 0, face = 0;
  const auto faces = static_cast<std::int32_t>(shapes.corner_of.size()) - 1;
  for (const ConvexPart& part : obstacle.parts) {
    vertices += static_cast<std::int32_t>(part.vertices.size());
    while (face < faces && item(shapes.corners, item(shapes.corner_of, face)) < vertices) ++face;
    shapes.face_of.push_back(face);
    shapes.vertex_of.push_back(vertices);
  }
  return shapes;
}

double Obstacle::radius() const { return size_of(*this); }

Obstacle half_space(const Vec3<double>& point, const Vec3<double>& normal) {
  Obstacle o;
  o.point = point;
  o.parts.resize(1);
  o.parts[0].planes = {{(1 / std::sqrt(dot(normal, normal))) * normal, 0}};
  return o;
}

Vec3<double> way_to_nearest(const std::vector<Obstacle>& obstacles, const Vec3<double>& from) {
  Vec3<double> shortest{};
  double least = std::numeric_limits<double>::infinity();
  for (const Obstacle& o : obstacles) {
    Vec3<double> way = o.point - from;
    if (o.is_half_space()) {
      const Vec3<double> normal = o.parts[0].planes[0].normal;
      way = dot(normal, way) * normal;
    }
    const double distance = length(way);
    if (distance < least) least = distance, shortest = way;
  }
  return {shortest.x, shortest.y, 0};
}

std::vector<NamedShape> shapes_of(const std::vector<Obstacle>& obstacles) {
  std::vector<NamedShape> shapes;
  for (const Obstacle& o : obstacles) {
    if (o.is_half_space()) continue;
    NamedShape& named = shapes.emplace_back();
    named.name = o.name;
    named.shape = o.shape;
    for (Vec3<double>& r : named.shape.vertices) r = r + o.point;
    for (const SurfacePatch& patch : o.patches) {
      named.patch_centres.push_back(patch.centre + o.point);
      named.patch_normals.push_back(patch.normal);
      named.patch_areas.push_back(patch.area);
      named.patch_sizes.insert(named.patch_sizes.end(), {patch.width, patch.height});
    }
  }
  return shapes;
}

Obstacle polyhedra(const Shapes& shapes, const Vec3<double>& point) {
  Obstacle o;
  o.point = point;
  for (std::int32_t body = 0; body < shapes.bodies(); ++body) {
    ConvexPart& part = o.parts.emplace_back();
    append_half_spaces(shapes, body, part.planes);
    const auto b = static_cast<std::size_t>(body);
    part.vertices.assign(shapes.vertices.begin() + shapes.vertex_of[b],
                         shapes.vertices.begin() + shapes.vertex_of[b + 1]);
  }
  append_to_body(o.shape, shapes, {});
  find_inner_faces(o);
  return o;
}

void add_parts(Obstacle& obstacle, const Obstacle& further) {
  const Vec3<double> way = further.point - obstacle.point;
  for (ConvexPart part : further.parts) {
    for (HalfSpace& plane : part.planes) plane.offset += dot(plane.normal, way);
    for (Vec3<double>& r : part.vertices) r = r + way;
    obstacle.parts.push_back(std::move(part));
  }
  append_to_body(obstacle.shape, further.shape, way);
  find_inner_faces(obstacle);
}

std::optional<PartsOverlap> overlap_of_parts(const Obstacle& obstacle) {
  constexpr double rounding = 1e-9;
  const auto parts = static_cast<std::int32_t>(obstacle.parts.size());
  if (parts < 2) return std::nullopt;
  const Shapes shapes = shapes_of_parts(obstacle);
  std::vector<double> volumes;
  volumes.reserve(obstacle.parts.size());
  for (std::int32_t k = 0; k < parts; ++k) volumes.push_back(volume_properties(shapes, k).volume);
  Clipper clipper;
  for (std::int32_t one = 0; one < parts; ++one) {
    const auto k = static_cast<std::size_t>(one);
    for (std::int32_t other = one + 1; other < parts; ++other) {
      const auto m = static_cast<std::size_t>(other);
      const double volume =
          clipper.overlap(shapes, one, obstacle.parts[k].vertices, obstacle.parts[m].planes).volume;
      if (volume > rounding * std::min(volumes[k], volumes[m]))
        return PartsOverlap{.one = one, .other = other, .volume = volume};
    }
  }
  return std::nullopt;
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
  return polyhedra(between(low, high), centre);
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
  return polyhedra(between(low, high), base);
}

}  // namespace floe
