// Gaps of pairs: lower bounds of distances, and found for nearly all pairs that are apart.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "contact/narrow_phase.h"
#include "support/polyhedra.h"
#include "support/random.h"

namespace floe {
namespace {

Placed placed_at(const Vec3<double>& x, const Quat<double>& q) {
  return {.x = x, .axes = triad(q)};
}

/// Random bodies, most of them near each other. A pair with a gap never overlaps, also when A has
/// gone towards B by all but the gap; of pairs without overlap all but a few have a gap.
TEST(NarrowPhase, FindsGapsOfNearlyAllPairsThatAreApart) {
  test::Random random(31);
  int apart = 0, found = 0, by_face = 0;
  for (int k = 0; k < 6000; ++k) {
    Shapes shapes;
    for (int body = 0; body < 2; ++body) {
      test::append_random(shapes, random, static_cast<int>(random.uniform(0, 6)));
      test::centre_last(shapes);
    }
    const std::vector<double> masses{1, 1};
    const Solids solids(shapes, masses, {});
    NarrowPhase narrow(false);
    const Wear wear;
    Pair pair{.a = 0, .b = 1, .slot_a = 0, .slot_b = 1, .axis = random.direction()};
    const Placed b = placed_at({}, random.rotation(random.uniform(0, 3)));
    Placed a = placed_at(2.2 * random.direction(), random.rotation(random.uniform(0, 3)));
    const bool overlap = narrow.overlap(solids, wear, pair, a, b).overlap.volume > 0;
    const bool is_apart = narrow.is_apart(solids, pair, a, b);
    apart += overlap ? 0 : 1;
    if (!is_apart) continue;
    EXPECT_FALSE(overlap) << k;
    ++found;
    by_face += pair.face >= 0 ? 1 : 0;
    a.x = a.x - (0.999 * pair.safe / length(a.x)) * a.x;
    EXPECT_EQ(narrow.overlap(solids, wear, pair, a, b).overlap.volume, 0) << k;
  }
  EXPECT_GT(apart, 1000);
  EXPECT_GT(found, 0.96 * apart);
  EXPECT_GT(by_face, 0.8 * found);
}

/// Two plates one above the other, the upper one turned: the gap is the distance of their faces,
/// whichever of the two is A, and is found at the face again after both have turned.
TEST(NarrowPhase, GapAtAFaceIsTheDistanceOfPlates) {
  Shapes shapes;
  test::append_box(shapes, 3, 2, 0.5);
  test::append_box(shapes, 2, 3, 0.5);
  const std::vector<double> masses{1, 1};
  const Solids solids(shapes, masses, {});
  NarrowPhase narrow(false);
  for (const double side : {1.0, -1.0}) {
    Pair pair{.a = 0, .b = 1, .slot_a = 0, .slot_b = 1, .axis = {0.6, 0, 0.8}};
    for (const double turn : {0.0, 0.7, 1.9}) {
      const Quat<double> q = exp_rotation({turn, 0.3 * turn, 0});
      const Vec3<double> up = rotate(q, {0, 0, 1});
      const Placed a = placed_at(side * 0.52 * up, product(q, exp_rotation({0, 0, 0.4})));
      pair.safe = 0;
      ASSERT_TRUE(narrow.is_apart(solids, pair, a, placed_at({}, q)));
      EXPECT_NEAR(pair.safe, 0.02, 1e-7);
      EXPECT_GE(pair.face, 0);
    }
  }
}

/// The height of a cube's lowest vertex above a floor, and of its face beside an obstacle's.
TEST(NarrowPhase, GapsOfObstacles) {
  Shapes shapes;
  test::append_box(shapes, 1, 1, 1);
  Obstacle floor;
  floor.parts.resize(1);
  floor.parts[0].planes = {{{0, 0, 1}, 0}};
  const std::vector<double> masses{1};
  const Solids solids(shapes, masses, {floor});
  NarrowPhase narrow(false);
  const Placed below = placed_at({}, {1, 0, 0, 0});
  Pair pair{.a = 0, .b = part_index(0), .slot_a = 0, .axis = {0, 0, 1}};
  const Placed on_edge = placed_at({5, 3, 0.8}, exp_rotation({0.25 * std::numbers::pi, 0, 0}));
  ASSERT_TRUE(narrow.is_apart(solids, pair, on_edge, below));
  EXPECT_NEAR(pair.safe, 0.8 - std::sqrt(0.5), 1e-6);
  pair.safe = 0;
  const Placed in_floor = placed_at({5, 3, 0.4}, {1, 0, 0, 0});
  EXPECT_FALSE(narrow.is_apart(solids, pair, in_floor, below));
  const PairOverlap met = narrow.overlap(solids, {}, pair, in_floor, below);
  EXPECT_NEAR(met.overlap.volume, 0.1, 1e-15);
  EXPECT_NEAR(met.depth, 0.05, 1e-15);
}

/// A body of more vertices than the fast clipper has room for.
TEST(NarrowPhase, OverlapsLargeBodiesToo) {
  std::vector<Point2> polygon;
  constexpr int sides = 40;
  for (int k = 0; k < sides; ++k) {
    const double angle = 2 * std::numbers::pi * (k + 0.5) / sides;
    polygon.push_back({std::cos(angle), std::sin(angle)});
  }
  Shapes shapes;
  append_prism(shapes, polygon, -0.5, 0.5);
  test::append_box(shapes, 4, 4, 1);
  const std::vector<double> masses{1, 1};
  const Solids solids(shapes, masses, {});
  EXPECT_EQ(solids.graph(0), nullptr);
  EXPECT_NE(solids.graph(1), nullptr);
  NarrowPhase narrow(true);
  Pair pair{.a = 0, .b = 1, .slot_a = 0, .slot_b = 1};
  const Quat<double> upright{1, 0, 0, 0};
  const PairOverlap met = narrow.overlap(solids, {}, pair, placed_at({0, 0, 0.9}, upright),
                                         placed_at({0, 0, 0}, upright));
  const double area = 0.5 * sides * std::sin(2 * std::numbers::pi / sides);
  EXPECT_NEAR(met.overlap.volume, 0.1 * area, 1e-14);
  EXPECT_NEAR(met.overlap.patch.area, area, 1e-13);
}

}  // namespace
}  // namespace floe
