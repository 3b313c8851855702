/// \file
/// The leapfrog step of rigid bodies, one body per lane.
#pragma once

#include <array>

#include "base/simd.h"
#include "leapfrog/rigid_body_step.h"

namespace floe {

/// Computes the drifts of lanes that turn far, one by one: such lanes are rare.
/// \param numbers  inverse inertia, axes, rotation and momentum before the drift; then rotation and
///   angular velocity after it, which change, and Drift::excess
[[gnu::noinline, gnu::cold]] inline void large_drifts(std::array<Lanes, 22>& numbers, double dt) {
  for (std::size_t k = 0; k < lanes; ++k) {
    if (numbers[21][k] < small_square) continue;
    const auto at = [&](std::size_t n) { return double(numbers[n][k]); };
    const auto vector = [&](std::size_t n) { return Vec3<double>{at(n), at(n + 1), at(n + 2)}; };
    const auto turn = [&](std::size_t n) {
      return Quat<double>{at(n), at(n + 1), at(n + 2), at(n + 3)};
    };
    const Drift<double> d = drift_of({0, vector(0), turn(3)}, turn(7), vector(11), dt);
    const std::array<double, 7> values{d.q.w, d.q.x, d.q.y, d.q.z, d.w.x, d.w.y, d.w.z};
    for (std::size_t n = 0; n < values.size(); ++n) numbers[14 + n][k] = values[n];
  }
}
inline void drift_rotation(const BodyConstants<Lanes>& body, BodyMotion<Lanes>& m, double dt) {
  Drift<Lanes> d = drift_of(body, m.q, m.momentum, dt);
  if (!all_of(d.excess < small_square)) [[unlikely]] {
    // Number by number: what is copied or passed whole lies in memory on the other path too.
    const Vec3<Lanes>& inverse = body.inverse_inertia;
    std::array<Lanes, 22> n{inverse.x,   inverse.y,    inverse.z,    body.axes.w,  body.axes.x,
                            body.axes.y, body.axes.z,  m.q.w,        m.q.x,        m.q.y,
                            m.q.z,       m.momentum.x, m.momentum.y, m.momentum.z, d.q.w,
                            d.q.x,       d.q.y,        d.q.z,        d.w.x,        d.w.y,
                            d.w.z,       d.excess};
    large_drifts(n, dt);
    d.q.w = n[14], d.q.x = n[15], d.q.y = n[16], d.q.z = n[17];
    d.w.x = n[18], d.w.y = n[19], d.w.z = n[20];
  }
  m.q = d.q;
  m.w = d.w;
}

}  // namespace floe
