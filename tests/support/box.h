/// \file
/// One box with a shape, for water.
#pragma once

#include "support/lattices.h"

namespace floe::test {

/// A box of the given sides along x, y, z, its centroid at the given height over the water.
inline Lattice box(const Point3& sides, double density, double height, const Point3& velocity,
                   const Point3& spin = {}) {
  const auto& [a, b, c] = sides;
  const double mass = density * a * b * c;
  Lattice one = frame({{0, 0, height}}, {});
  one.bodies.mass = {mass};
  one.bodies.inertia = {
      {mass * (b * b + c * c) / 12, mass * (a * a + c * c) / 12, mass * (a * a + b * b) / 12}};
  one.bodies.velocity = {velocity};
  one.bodies.angular_velocity = {spin};
  for (const double z : {-c / 2, c / 2}) {
    for (const auto& [x, y] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}})
      one.shapes.vertices.push_back({x * a / 2, y * b / 2, z});
  }
  one.shapes.corners = {3, 2, 1, 0, 4, 5, 6, 7, 0, 1, 5, 4, 1, 2, 6, 5, 2, 3, 7, 6, 3, 0, 4, 7};
  one.shapes.corner_of = {0, 4, 8, 12, 16, 20, 24};
  one.shapes.face_of = {0, 6};
  one.shapes.vertex_of = {0, 8};
  return one;
}

}  // namespace floe::test
