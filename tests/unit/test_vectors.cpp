// Components of a vector by index, comparison and sign.
#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <vector>

#include "floe/base/rotation.h"
#include "floe/geometry/polyhedron.h"

namespace floe {
namespace {

TEST(Vector, HasItsComponentsByNameAndByIndex) {
  Point3 p{1, 2, 3};
  EXPECT_EQ((std::array{p[0], p[1], p[2]}), (std::array{1.0, 2.0, 3.0}));
  EXPECT_EQ((std::array{p.x, p.y, p.z}), (std::array{1.0, 2.0, 3.0}));
  const auto [x, y, z] = p;
  EXPECT_EQ((std::array{x, y, z}), (std::array{1.0, 2.0, 3.0}));
  for (std::size_t k = 0; k < 3; ++k) p[k] = 10 * p[k];
  EXPECT_EQ(p, (Point3{10, 20, 30}));
}

TEST(Vector, IndexIsConstantExpression) {
  constexpr Vec3<int> v{4, 5, 6};
  static_assert(v[0] == 4 && v[1] == 5 && v[2] == 6);
  constexpr auto changed = [] {
    Vec3<int> w{};
    w[1] = 7;
    return w;
  };
  static_assert(changed() == Vec3<int>{0, 7, 0});
}

TEST(Vector, EqualityTakesEveryComponent) {
  const Vec3<double> v{1, 2, 3};
  EXPECT_EQ(v, v);
  for (std::size_t k = 0; k < 3; ++k) {
    Vec3<double> other = v;
    other[k] += 1;
    EXPECT_NE(v, other) << k;
  }
  EXPECT_EQ((Vec3<double>{0, 0, 0}), (Vec3<double>{-0.0, -0.0, -0.0}));
  const double none = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE((Vec3<double>{1, none, 3}), (Vec3<double>{1, none, 3}));
}

TEST(Vector, MinusTurnsItRound) { EXPECT_EQ(-(Vec3<double>{1, -2, 3}), (Vec3<double>{-1, 2, -3})); }

/// Files and messages take vectors in a row as numbers in a row.
TEST(Vector, VectorsInARowAreNumbersInARow) {
  const std::vector<Point3> rows{{1, 2, 3}, {4, 5, 6}};
  const auto* numbers = reinterpret_cast<const double*>(rows.data());
  EXPECT_EQ(std::vector<double>(numbers, numbers + 6), (std::vector<double>{1, 2, 3, 4, 5, 6}));
}

}  // namespace
}  // namespace floe
