/// \file
/// The beam kernel on lanes: relative rotations, which branch.
#pragma once

#include <array>

#include "base/simd.h"
#include "beams/kernel.h"

namespace floe {

/// Computes large turns lane by lane: such lanes are rare (a beam bent by 11 degrees).
/// \param numbers  a, then b, difference, square and h of Between, which change
[[gnu::noinline, gnu::cold]] inline void large_turns(std::array<Lanes, 14>& numbers) {
  for (std::size_t k = 0; k < lanes; ++k) {
    if (numbers[12][k] < series_limit) continue;
    const auto at = [&](std::size_t n) { return double(numbers[n][k]); };
    const Between<double> r =
        between(Quat<double>{at(0), at(1), at(2), at(3)}, Quat<double>{at(4), at(5), at(6), at(7)});
    const std::array<double, 10> values{
        r.b.w,          r.b.x,          r.b.y,          r.b.z,    r.difference.w,
        r.difference.x, r.difference.y, r.difference.z, r.square, r.h};
    for (std::size_t n = 0; n < values.size(); ++n) numbers[4 + n][k] = values[n];
  }
}
inline Between<Lanes> between(const Quat<Lanes>& a, const Quat<Lanes>& b) {
  Between<Lanes> r{b, b - a, {}, {}};
  r.square = dot(r.difference, r.difference);
  r.h = remainder_series(r.square);
  if (!all_of(r.square < series_limit)) [[unlikely]] {
    // Number by number: what is copied or passed whole lies in memory on the other path too.
    std::array<Lanes, 14> n{a.w,
                            a.x,
                            a.y,
                            a.z,
                            r.b.w,
                            r.b.x,
                            r.b.y,
                            r.b.z,
                            r.difference.w,
                            r.difference.x,
                            r.difference.y,
                            r.difference.z,
                            r.square,
                            r.h};
    large_turns(n);
    r.b.w = n[4], r.b.x = n[5], r.b.y = n[6], r.b.z = n[7];
    r.difference.w = n[8], r.difference.x = n[9], r.difference.y = n[10], r.difference.z = n[11];
    r.square = n[12], r.h = n[13];
  }
  return r;
}

}  // namespace floe
