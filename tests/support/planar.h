// Planar states, and what of space lies in the plane.
#pragma once

#include <array>
#include <cmath>
#include <vector>

#include "floe/lattice/state.h"
#include "lattice/partition.h"
#include "support/random.h"

namespace floe::test {

/// Displacements up to `size` [m], a common turn [rad], others up to `turn` beside it, and
/// velocities up to 1 m/s and 1 rad/s: a body's depend on its global number only.
inline State<Planar> deformed_in_plane(const Part& part, double size, double turn,
                                       double common = 0) {
  State<Planar> state(static_cast<std::size_t>(part.local));
  for (std::size_t b = 0; b < static_cast<std::size_t>(part.local); ++b) {
    Random random(1000 + static_cast<std::uint64_t>(part.global[b]));
    const Vec3<double> u = random.vector(size), v = random.vector(1);
    const Point3& x = part.bodies.position[b];
    double* r = state.record(b);
    r[0] = u.x + std::cos(common) * x[0] - std::sin(common) * x[1] - x[0];
    r[1] = u.y + std::sin(common) * x[0] + std::cos(common) * x[1] - x[1];
    r[Planar::rotation] = common + random.uniform(-turn, turn);
    r[Planar::velocity] = v.x, r[Planar::velocity + 1] = v.y;
    r[Planar::angular_velocity] = v.z;
  }
  return state;
}

/// Rows and columns of x y rz of 6 x 6 blocks, row-major. \param bodies  blocks in a row
inline std::vector<double> in_plane(const std::vector<double>& matrix, std::size_t bodies) {
  std::vector<double> part;
  for (std::size_t r = 0; r < 3 * bodies; ++r) {
    for (std::size_t c = 0; c < 3 * bodies; ++c) {
      const auto at = [](std::size_t k) {
        return 6 * (k / 3) + static_cast<std::size_t>(Planar::components[k % 3]);
      };
      part.push_back(matrix[at(r) * 6 * bodies + at(c)]);
    }
  }
  return part;
}

}  // namespace floe::test
