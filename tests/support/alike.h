/// \file
/// States of bodies compared by what is largest in them.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "floe/lattice/state.h"

namespace floe::test {

/// Largest difference of numbers first .. first + count of all records, over the largest of them.
inline double difference(const State<Spatial>& a, const State<Spatial>& b, int first, int count) {
  double largest = 0, difference = 0;
  for (std::size_t at = 0; at < a.records.size(); at += Spatial::record) {
    for (int k = first; k < first + count; ++k) {
      const std::size_t n = at + static_cast<std::size_t>(k);
      largest = std::max(largest, std::abs(a.records[n]));
      difference = std::max(difference, std::abs(a.records[n] - b.records[n]));
    }
  }
  return largest > 0 ? difference / largest : difference;
}

inline void expect_alike(const State<Spatial>& a, const State<Spatial>& b, double tolerance) {
  EXPECT_LT(difference(a, b, Spatial::displacement, 3), tolerance);
  EXPECT_LT(difference(a, b, Spatial::rotation, 4), tolerance);
  EXPECT_LT(difference(a, b, Spatial::velocity, 3), tolerance);
  EXPECT_LT(difference(a, b, Spatial::angular_velocity, 3), tolerance);
  EXPECT_LT(difference(a, b, Spatial::angular_momentum, 3), tolerance);
}

}  // namespace floe::test
