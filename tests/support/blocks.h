/// \file
/// Loose blocks, built in code as floe.lattice builds them.
#pragma once

#include <array>
#include <Eigen/Eigenvalues>
#include <vector>

#include "floe/lattice/lattice.h"
#include "support/polyhedra.h"

namespace floe::test {

inline void append_block_body(Lattice& lattice, const Vec3<double>& at, const Quat<double>& q,
                              double mass, const Point3& inertia, const Vec3<double>& velocity,
                              const Vec3<double>& spin) {
  Bodies& b = lattice.bodies;
  b.position.push_back(at);
  b.orientation.push_back({q.w, q.x, q.y, q.z});
  b.mass.push_back(mass);
  b.inertia.push_back(inertia);
  b.velocity.push_back(velocity);
  b.angular_velocity.push_back(spin);
  lattice.sets["all"].push_back(b.size() - 1);
}

/// A box with its centroid at `at`.
inline void append_block(Lattice& lattice, const Vec3<double>& size, const Vec3<double>& at,
                         const Quat<double>& q = {1, 0, 0, 0}, const Vec3<double>& velocity = {},
                         const Vec3<double>& spin = {}, double density = 920) {
  append_box(lattice.shapes, size.x, size.y, size.z);
  const double mass = density * size.x * size.y * size.z;
  const auto moment = [&](double a, double b) { return mass * (a * a + b * b) / 12; };
  append_block_body(lattice, at, q, mass,
                    {moment(size.y, size.z), moment(size.x, size.z), moment(size.x, size.y)},
                    velocity, spin);
}

/// A random polyhedron of about 2 m, its vertices turned to principal axes.
inline void append_stone(Lattice& lattice, Random& random, const Vec3<double>& at,
                         const Quat<double>& q, const Vec3<double>& velocity,
                         const Vec3<double>& spin, double density = 920) {
  Shapes& shapes = lattice.shapes;
  append_random(shapes, random, 5, {1, random.uniform(0.5, 1), random.uniform(0.5, 1)});
  centre_last(shapes);
  const std::int32_t body = shapes.bodies() - 1;
  const VolumeProperties p = volume_properties(shapes, body);
  const Eigen::Matrix3d tensor =
      Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(p.inertia.data());
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(tensor);
  Eigen::Matrix3d axes = solver.eigenvectors();
  if (axes.determinant() < 0) axes.col(2) *= -1;
  for (auto v = static_cast<std::size_t>(shapes.vertex_of[static_cast<std::size_t>(body)]);
       v < shapes.vertices.size(); ++v) {
    Point3& r = shapes.vertices[v];
    const Eigen::Vector3d turned = axes.transpose() * Eigen::Vector3d(r.x, r.y, r.z);
    r = {turned[0], turned[1], turned[2]};
  }
  const Eigen::Vector3d moments = density * solver.eigenvalues();
  append_block_body(lattice, at, q, density * p.volume, {moments[0], moments[1], moments[2]},
                    velocity, spin);
}

}  // namespace floe::test
