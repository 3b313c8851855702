/// \file
/// Vectors across a direction, by two components.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include "floe/base/rotation.h"

namespace floe {

/// A vector across the direction of S.
/// \tparam T  double, or lanes of doubles
template <class T>
struct Across {
  T u, v;
};

/// Returns two unit vectors that with n are a right-handed basis u, v, n (Duff et al. 2017,
/// "Building an orthonormal basis, revisited", J. Comput. Graph. Tech. 6). \param n  unit vector
template <class T = double>
constexpr std::pair<Vec3<T>, Vec3<T>> basis_across(const Vec3<T>& n) {
  const T sign = std::copysign(1.0, n.z);
  const T a = -1 / (sign + n.z), b = n.x * n.y * a;
  return {{1 + sign * n.x * n.x * a, sign * b, -sign * n.x}, {b, sign + n.y * n.y * a, -n.y}};
}

/// Returns int rho dA over the triangle between the origin and an edge from a to b; below 0 where
/// the edge runs clockwise [m^3]. It is a third of twice the area times the mean of rho along the
/// edge, here by the rule of Gauss-Legendre with four points: 6e-5 too large for a square about its
/// centre, at most 1.5 % for narrow rectangles.
template <class T>
constexpr T reach_of_edge(const Across<T>& a, const Across<T>& b) {
  using std::sqrt;
  constexpr std::array<double, 4> at{0.06943184420297371, 0.33000947820757187, 0.6699905217924281,
                                     0.9305681557970263};
  constexpr std::array<double, 4> weight{0.17392742256872693, 0.32607257743127307,
                                         0.32607257743127307, 0.17392742256872693};
  std::array<T, 4> rho;
  for (std::size_t k = 0; k < 4; ++k) {
    const T u = a.u + at[k] * (b.u - a.u), v = a.v + at[k] * (b.v - a.v);
    rho[k] = sqrt(u * u + v * v);
  }
  const T mean =
      (weight[0] * rho[0] + weight[1] * rho[1]) + (weight[2] * rho[2] + weight[3] * rho[3]);
  return (1.0 / 3) * (a.u * b.v - a.v * b.u) * mean;
}

}  // namespace floe
