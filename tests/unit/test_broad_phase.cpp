// Neighbours from the grid against all pairs.

#include <gtest/gtest.h>

#include <algorithm>

#include "contact/broad_phase.h"
#include "floe/base/item.h"
#include "support/random.h"

namespace floe {
namespace {

/// Bodies of very different sizes, some that are left out, some far away.
TEST(NearPairs, AreThoseOfAllPairs) {
  test::Random random(4);
  for (const double largest : {1.0, 3.0, 30.0, 1000.0}) {
    std::vector<Vec3<double>> centres;
    std::vector<double> radii;
    std::vector<std::uint8_t> wanted;
    for (int k = 0; k < 400; ++k) {
      centres.push_back(random.vector(7));
      radii.push_back(k % 50 == 7 ? largest : random.uniform(0.3, 1));
      wanted.push_back(k % 3 == 0 ? 0 : 1);
    }
    radii[11] = -1;
    centres[12] = {1e12, 0, -1e12};
    constexpr double reach = 0.2;
    std::vector<BodyPair> found, expected;
    near_pairs(centres, radii, reach, wanted, found);
    for (std::int32_t i = 0; i < 400; ++i) {
      for (std::int32_t j = i + 1; j < 400; ++j) {
        const auto a = static_cast<std::size_t>(i), b = static_cast<std::size_t>(j);
        if (radii[a] < 0 || radii[b] < 0 || (wanted[a] == 0 && wanted[b] == 0)) continue;
        const Vec3<double> d = centres[a] - centres[b];
        const double most = radii[a] + radii[b] + reach;
        if (dot(d, d) <= most * most) expected.push_back({i, j});
      }
    }
    std::sort(found.begin(), found.end());
    EXPECT_GT(expected.size(), 60U);
    EXPECT_EQ(found, expected) << largest;
  }
}

TEST(NearPairs, OfNobodyAreNone) {
  std::vector<BodyPair> found{{1, 2}};
  near_pairs({}, {}, 0.1, {}, found);
  EXPECT_TRUE(found.empty());
}

/// The pairs of spheres whose nearest images are near, by brute force; wherever the spheres are.
TEST(NearPairs, AreThoseOfNearestImages) {
  test::Random random(11);
  const Periods periods{{6, 5, 0}};
  std::vector<Vec3<double>> centres;
  std::vector<double> radii;
  for (int k = 0; k < 120; ++k) {
    const Vec3<double> c{random.uniform(0, 6.0), random.uniform(0, 5.0), random.uniform(0, 3.0)};
    centres.push_back(c + Vec3<double>{6.0 * (k % 5 - 2), 5.0 * (k % 3 - 1), 0});
    radii.push_back(random.uniform(0.1, 0.5));
  }
  const std::vector<std::uint8_t> wanted(centres.size(), 1);
  constexpr double reach = 0.1;
  std::vector<BodyPair> expected, found;
  for (std::int32_t i = 0; i < 120; ++i) {
    for (std::int32_t j = i + 1; j < 120; ++j) {
      const Vec3<double> d = periods.nearest(item(centres, i) - item(centres, j));
      if (length(d) <= item(radii, i) + item(radii, j) + reach) expected.push_back({i, j});
    }
  }
  near_pairs(centres, radii, reach, wanted, found, periods);
  std::sort(found.begin(), found.end());
  EXPECT_EQ(found, expected);
  EXPECT_GT(expected.size(), 60U);
}

}  // namespace
}  // namespace floe
