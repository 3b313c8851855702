// States of a lattice and their small changes, for finite differences.
#pragma once

#include <cmath>
#include <functional>
#include <vector>

#include "floe/lattice/state.h"
#include "lattice/partition.h"
#include "support/random.h"

namespace floe::test {

inline void put_rotation(State<Spatial>& state, std::size_t body, const Quat<double>& q) {
  double* r = state.record(body) + Spatial::rotation;
  r[0] = q.w, r[1] = q.x, r[2] = q.y, r[3] = q.z;
}

/// Moves unknown k of a body: a displacement, or a spin q -> exp(t) q.
inline void move(State<Spatial>& state, std::size_t body, int k, double amount) {
  if (k < 3) {
    state.record(body)[k] += amount;
    return;
  }
  const Vec3<double> t{k == 3 ? amount : 0, k == 4 ? amount : 0, k == 5 ? amount : 0};
  put_rotation(state, body, normalised(product(exp_rotation(t), rotation(state, body))));
}

/// Displacements up to `size` [m] and rotations up to `turn` [rad]: a body's depend on its global
/// number only.
inline State<Spatial> deformed(const Part& part, double size, double turn) {
  State<Spatial> state(static_cast<std::size_t>(part.local));
  for (std::size_t b = 0; b < static_cast<std::size_t>(part.local); ++b) {
    Random random(1000 + static_cast<std::uint64_t>(part.global[b]));
    const Vec3<double> u = random.vector(size);
    double* r = state.record(b);
    r[0] = u.x, r[1] = u.y, r[2] = u.z;
    put_rotation(state, b, random.rotation(random.uniform(-turn, turn)));
  }
  return state;
}

/// Derivative at 0 of a function that fills `values`, to the fourth order in `step`.
template <class T, class Function>
std::vector<T> derivative(const Function& values, T step) {
  const std::vector<T> p2 = values(2 * step), p1 = values(step), m1 = values(-step),
                       m2 = values(-2 * step);
  std::vector<T> d(p1.size());
  for (std::size_t k = 0; k < d.size(); ++k)
    d[k] = (8 * (p1[k] - m1[k]) - (p2[k] - m2[k])) / (12 * step);
  return d;
}

}  // namespace floe::test
