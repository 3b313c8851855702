// Roots on a line: far ends of intervals of convex functions, and near roots.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "paths/root_search.h"

namespace floe {
namespace {

TEST(FarEnd, IsTheUpperEndOfTheIntervalFromWhereverOneStarts) {
  for (const double unit : {1e-6, 1e-2, 1.0, 100.0}) {
    for (const double at : {0.5, 1.0, 2.9, -3.0, 7.0}) {  // the interval is [1, 3] less `at`
      const auto g = [at](double t) { return std::abs(t + at - 2) - 1; };
      const auto end = far_end(g, unit, 1e-12);
      ASSERT_TRUE(end) << unit << " " << at;
      EXPECT_NEAR(*end, 3 - at, 1e-10) << unit << " " << at;
    }
    const auto square = [](double t) { return t * t - 2; };
    EXPECT_NEAR(far_end(square, unit, 1e-13).value_or(0), std::sqrt(2), 1e-12);
  }
}

TEST(FarEnd, IsNothingWhereTheFunctionIsAboveZeroOrFlat) {
  EXPECT_FALSE(far_end([](double t) { return t * t + 0.1; }, 1, 1e-12));
  EXPECT_FALSE(far_end([](double t) { return std::max(2 - t, t - 1.9); }, 0.01, 1e-12));
  EXPECT_FALSE(far_end([](double) { return -1.0; }, 1, 1e-12));
  EXPECT_FALSE(far_end([](double) { return 1.0; }, 1, 1e-12));
}

TEST(FarEnd, FindsAShortInterval) {
  const auto g = [](double t) { return std::max(5 - t, t - 5.01); };
  EXPECT_NEAR(far_end(g, 1, 1e-12).value_or(0), 5.01, 1e-10);
}

TEST(NearRoot, FollowsTheSlope) {
  EXPECT_NEAR(near_root([](double t) { return 3 - 2 * t; }, 1, 1e-12).value_or(0), 1.5, 1e-12);
  EXPECT_NEAR(near_root([](double t) { return std::exp(t) - 0.5; }, 1, 1e-12).value_or(0),
              std::log(0.5), 1e-11);
  EXPECT_EQ(near_root([](double t) { return 1e-14 + t; }, 1, 1e-12), 0.0);
  EXPECT_FALSE(near_root([](double) { return 1.0; }, 1, 1e-12));
}

}  // namespace
}  // namespace floe
