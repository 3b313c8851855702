/// \file
/// Convex polyhedra for tests: boxes, and random ones with planar faces (three faces at a vertex).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "geometry/overlap.h"
#include "support/random.h"

namespace floe::test {

/// Appends a body to `shapes`: vertices, faces counter-clockwise seen from outside.
inline void append_body(Shapes& shapes, const std::vector<Point3>& vertices,
                        const std::vector<std::vector<std::int32_t>>& faces) {
  const auto base = static_cast<std::int32_t>(shapes.vertices.size());
  shapes.vertices.insert(shapes.vertices.end(), vertices.begin(), vertices.end());
  for (const auto& face : faces) {
    for (const std::int32_t v : face) shapes.corners.push_back(base + v);
    shapes.corner_of.push_back(static_cast<std::int32_t>(shapes.corners.size()));
  }
  shapes.face_of.push_back(static_cast<std::int32_t>(shapes.corner_of.size()) - 1);
  shapes.vertex_of.push_back(static_cast<std::int32_t>(shapes.vertices.size()));
}

/// A box of edges a, b, c about the origin.
inline void append_box(Shapes& shapes, double a, double b, double c) {
  std::vector<Point3> v;
  for (const double z : {-c / 2, c / 2})
    for (const double y : {-b / 2, b / 2})
      for (const double x : {-a / 2, a / 2}) v.push_back({x, y, z});
  append_body(shapes, v,
              {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}});
}

/// The box [-1, 1]^3 cut by `planes` random ones that leave the ball of radius 0.4 whole, then
/// stretched by `stretch`. Faces are found by brute force over triples of planes.
inline void append_random(Shapes& shapes, Random& random, int planes,
                          const Vec3<double>& stretch = {1, 1, 1}) {
  std::vector<HalfSpace> all{{{1, 0, 0}, 1},  {{-1, 0, 0}, 1}, {{0, 1, 0}, 1},
                             {{0, -1, 0}, 1}, {{0, 0, 1}, 1},  {{0, 0, -1}, 1}};
  for (int k = 0; k < planes; ++k) all.push_back({random.direction(), random.uniform(0.4, 1.0)});
  std::vector<Vec3<double>> vertices;
  std::vector<std::vector<std::int32_t>> of_plane(all.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    for (std::size_t j = i + 1; j < all.size(); ++j) {
      for (std::size_t k = j + 1; k < all.size(); ++k) {
        const Vec3<double> jk = cross(all[j].normal, all[k].normal),
                           ki = cross(all[k].normal, all[i].normal),
                           ij = cross(all[i].normal, all[j].normal);
        const double d = dot(all[i].normal, jk);
        if (std::abs(d) < 1e-9) continue;
        const Vec3<double> p =
            (1 / d) * (all[i].offset * jk + all[j].offset * ki + all[k].offset * ij);
        const bool inside = std::all_of(all.begin(), all.end(), [&](const HalfSpace& h) {
          return dot(h.normal, p) <= h.offset + 1e-12;
        });
        if (!inside) continue;
        const auto v = static_cast<std::int32_t>(vertices.size());
        vertices.push_back(p);
        for (const std::size_t f : {i, j, k}) of_plane[f].push_back(v);
      }
    }
  }
  std::vector<std::vector<std::int32_t>> faces;
  for (std::size_t f = 0; f < all.size(); ++f) {
    auto& loop = of_plane[f];
    if (loop.size() < 3) continue;
    Vec3<double> middle{};
    for (const std::int32_t v : loop)
      middle =
          middle + (1.0 / static_cast<double>(loop.size())) * vertices[static_cast<std::size_t>(v)];
    const Vec3<double> n = all[f].normal;
    Vec3<double> e = vertices[static_cast<std::size_t>(loop[0])] - middle;
    e = e - dot(e, n) * n;
    const Vec3<double> g = cross(n, e);
    const auto angle = [&](std::int32_t v) {
      const Vec3<double> r = vertices[static_cast<std::size_t>(v)] - middle;
      return std::atan2(dot(r, g), dot(r, e));
    };
    std::sort(loop.begin(), loop.end(),
              [&](std::int32_t a, std::int32_t b) { return angle(a) < angle(b); });
    faces.push_back(loop);
  }
  std::vector<Point3> points;
  for (const auto& v : vertices)
    points.push_back({stretch.x * v.x, stretch.y * v.y, stretch.z * v.z});
  append_body(shapes, points, faces);
}

/// Moves the vertices of the last body so that the centroid is the origin, and turns nothing.
inline void centre_last(Shapes& shapes) {
  const std::int32_t b = shapes.bodies() - 1;
  const Point3 c = volume_properties(shapes, b).centroid;
  for (auto v = static_cast<std::size_t>(shapes.vertex_of[static_cast<std::size_t>(b)]);
       v < shapes.vertices.size(); ++v)
    shapes.vertices[v] = shapes.vertices[v] - c;
}

/// Vertices of a body, turned, then moved.
inline std::vector<Vec3<double>> placed(const Shapes& shapes, std::int32_t body,
                                        const Quat<double>& q, const Vec3<double>& x) {
  std::vector<Vec3<double>> p;
  for (std::int32_t v = shapes.vertex_of[static_cast<std::size_t>(body)];
       v < shapes.vertex_of[static_cast<std::size_t>(body) + 1]; ++v)
    p.push_back(x + rotate(q, shapes.vertices[static_cast<std::size_t>(v)]));
  return p;
}

}  // namespace floe::test
