// The interface of two convex bodies against closed forms, and against sums over a fine grid.
#include "geometry/interface.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <optional>

#include "geometry/across.h"
#include "support/polyhedra.h"
#include "support/random.h"

namespace floe {
namespace {

using test::placed, test::Random;

constexpr Quat<double> upright{1, 0, 0, 0};

/// Two bodies, and how the second lies to the first.
struct Two {
  Shapes shapes;
  Quat<double> turn = upright;
  Vec3<double> at{};

  std::optional<Interface> find(double reach, const Quat<double>& all = upright,
                                const Vec3<double>& shift = {}) const {
    const auto first = placed(shapes, 0, all, shift);
    const auto second = placed(shapes, 1, product(all, turn), shift + rotate(all, at));
    return find_interface(shapes, 0, 1, first, second, reach);
  }
};

Two boxes(const Vec3<double>& a, const Vec3<double>& b, const Vec3<double>& at) {
  Two two;
  test::append_box(two.shapes, a.x, a.y, a.z);
  test::append_box(two.shapes, b.x, b.y, b.z);
  two.at = at;
  return two;
}

void expect_near(const Vec3<double>& a, const Vec3<double>& b, double by) {
  EXPECT_NEAR(a.x, b.x, by);
  EXPECT_NEAR(a.y, b.y, by);
  EXPECT_NEAR(a.z, b.z, by);
}

/// Two boxes side by side, shifted along their face: the common rectangle, its place, its moments.
TEST(Interfaces, OfBoxesIsTheCommonRectangle) {
  const Two two = boxes({2, 3, 1}, {2, 2, 4}, {2.1, 1.5, 0.5});
  const auto face = two.find(0.2);
  ASSERT_TRUE(face);
  // In y from 0.5 to 1.5, in z from -0.5 to 0.5; in x from 1 to 1.1.
  EXPECT_NEAR(face->gap, 0.1, 1e-12);
  expect_near(face->normal, {1, 0, 0}, 1e-12);
  EXPECT_NEAR(face->area, 1.0, 1e-12);
  expect_near(face->centre, {1.05, 1.0, 0.0}, 1e-12);
  EXPECT_NEAR(face->most, 1.0 / 12, 1e-12);
  EXPECT_NEAR(face->least, 1.0 / 12, 1e-12);
  const Two wide = boxes({2, 3, 1}, {2, 3, 4}, {2.1, 0.5, 0.25});  // y from -1 to 1.5
  const auto rectangle = wide.find(0.2);
  ASSERT_TRUE(rectangle);
  EXPECT_NEAR(rectangle->area, 2.5, 1e-12);
  EXPECT_NEAR(rectangle->most, std::pow(2.5, 3) / 12, 1e-12);
  EXPECT_NEAR(rectangle->least, 2.5 / 12, 1e-12);
  EXPECT_NEAR(std::abs(rectangle->axis.y), 1.0, 1e-12);
}

TEST(Interfaces, AreNoneBeyondTheReach) {
  const Two two = boxes({1, 1, 1}, {1, 1, 1}, {1.1, 0, 0});
  EXPECT_TRUE(two.find(0.1 + 1e-9));
  EXPECT_FALSE(two.find(0.1 - 1e-9));
  EXPECT_FALSE(boxes({1, 1, 1}, {1, 1, 1}, {1.05, 1.05, 0}).find(0.1));  // edge beside edge
}

/// Bodies that were pressed together overlap a little; their face is that where they met.
TEST(Interfaces, OfBoxesThatOverlapHaveNegativeGaps) {
  const auto face = boxes({1, 1, 1}, {1, 1, 1}, {0.25, 0, 0.98}).find(0.0);
  ASSERT_TRUE(face);
  EXPECT_NEAR(face->gap, -0.02, 1e-12);
  expect_near(face->normal, {0, 0, 1}, 1e-12);
  EXPECT_NEAR(face->area, 0.75, 1e-12);
  EXPECT_NEAR(face->centre.z, 0.49, 1e-12);
}

/// Faces at an angle: only where the gap between them is within the reach.
TEST(Interfaces, OfAWedgeEndsWhereTheGapIsTheReach) {
  Two two = boxes({4, 1, 1}, {4, 1, 1}, {});
  constexpr double angle = 0.1;
  two.turn = exp_rotation({0, -angle, 0});  // its far end goes up
  // The lower left edge of the upper box touches the lower box at x = -2, z = 1/2.
  const Vec3<double> edge = rotate(two.turn, {-2, 0, -0.5});
  two.at = Vec3<double>{-2, 0, 0.5} - edge;
  constexpr double reach = 0.05;
  const auto face = two.find(reach);
  ASSERT_TRUE(face);
  EXPECT_NEAR(face->gap, 0, 1e-12);
  const double far = reach / std::tan(angle);
  if (std::abs(face->normal.z - 1) < 1e-9) {
    EXPECT_NEAR(face->area, far, 1e-9);
    EXPECT_NEAR(face->centre.x, -2 + far / 2, 1e-9);
    EXPECT_NEAR(face->centre.z, 0.5 + reach / 4, 1e-9);
  } else {  // the upper face's normal: as wide a gap
    EXPECT_NEAR(face->area, far, 0.02 * far);
  }
}

TEST(Interfaces, LieInNoThirdBody) {
  Shapes box;
  test::append_box(box, 2, 1, 1);
  const auto corners = placed(box, 0, upright, {1, 0, 0});
  EXPECT_TRUE(is_inside(box, 0, corners, {1.9, 0.4, -0.4}, 0));
  EXPECT_FALSE(is_inside(box, 0, corners, {2.1, 0.4, -0.4}, 0.05));
  EXPECT_TRUE(is_inside(box, 0, corners, {2.1, 0.4, -0.4}, 0.15));
  EXPECT_FALSE(is_inside(box, 0, corners, {-0.9, 0, 0}, 0.15));
}

TEST(Interfaces, TurnWithTheBodies) {
  Random random(7);
  for (int k = 0; k < 30; ++k) {
    Two two;
    test::append_random(two.shapes, random, 5);
    test::append_random(two.shapes, random, 5);
    two.turn = exp_rotation(random.uniform(0.0, 3.0) * random.direction());
    two.at = 1.7 * random.direction();
    const auto face = two.find(0.3);
    const Quat<double> turn = exp_rotation(random.uniform(0.0, 3.0) * random.direction());
    const Vec3<double> shift = 1e3 * random.direction();
    const auto turned = two.find(0.3, turn, shift);
    ASSERT_EQ(face.has_value(), turned.has_value());
    if (!face) continue;
    EXPECT_NEAR(turned->gap, face->gap, 1e-9);
    expect_near(turned->normal, rotate(turn, face->normal), 1e-6);
    EXPECT_NEAR(turned->area, face->area, 1e-6);
    expect_near(turned->centre, shift + rotate(turn, face->centre), 1e-6);
    EXPECT_NEAR(turned->most, face->most, 1e-6);
    EXPECT_NEAR(turned->least, face->least, 1e-6);
  }
}

/// Highest (side = 1) or lowest point of a body on a line along n; nothing where the line misses.
std::optional<double> end_on_line(const Shapes& shapes, std::int32_t body,
                                  const std::vector<Vec3<double>>& vertices,
                                  const Vec3<double>& on_line, const Vec3<double>& n, double side) {
  double from = -1e9, to = 1e9;
  const auto b = static_cast<std::size_t>(body);
  for (std::int32_t f = shapes.face_of[b]; f < shapes.face_of[b + 1]; ++f) {
    const auto corner = [&](std::int32_t k) {
      const auto at = static_cast<std::size_t>(shapes.corner_of[static_cast<std::size_t>(f)] + k);
      return vertices[static_cast<std::size_t>(shapes.corners[at] - shapes.vertex_of[b])];
    };
    const Vec3<double> m = cross(corner(1) - corner(0), corner(2) - corner(0));
    const double speed = dot(m, n), room = dot(m, corner(0) - on_line);
    if (speed > 1e-12)
      to = std::min(to, room / speed);
    else if (speed < -1e-12)
      from = std::max(from, room / speed);
    else if (room < 0)
      return std::nullopt;
  }
  if (from > to) return std::nullopt;
  return side > 0 ? to : from;
}

/// Random bodies: the area is that of the lines along the normal on which the gap is within reach.
TEST(Interfaces, HaveTheAreaOfLinesWithinReach) {
  Random random(3);
  constexpr double reach = 0.25;
  int found = 0;
  for (int k = 0; k < 40; ++k) {
    Two two;
    test::append_random(two.shapes, random, 4);
    test::append_random(two.shapes, random, 4);
    two.turn = exp_rotation(random.uniform(0.0, 3.0) * random.direction());
    two.at = 1.9 * random.direction();
    const auto face = two.find(reach);
    if (!face) continue;
    ++found;
    const auto first = placed(two.shapes, 0, upright, {});
    const auto second = placed(two.shapes, 1, two.turn, two.at);
    const auto [u, v] = basis_across(face->normal);
    constexpr int cells = 200;
    constexpr double half = 2.0, width = 2 * half / cells;
    double area = 0, height = 0;
    Vec3<double> middle{};
    for (int p = 0; p < cells; ++p) {
      for (int q = 0; q < cells; ++q) {
        const Vec3<double> on_line =
            (-half + (p + 0.5) * width) * u + (-half + (q + 0.5) * width) * v;
        const auto low = end_on_line(two.shapes, 0, first, on_line, face->normal, 1);
        const auto high = end_on_line(two.shapes, 1, second, on_line, face->normal, -1);
        if (!low || !high || *high - *low > reach) continue;
        area += width * width;
        height = (*low + *high) / 2;
        middle = middle + width * width * (on_line + height * face->normal);
      }
    }
    EXPECT_NEAR(face->area, area, 0.03 * area + 0.002) << k;
    if (area > 0.05) expect_near(face->centre, (1 / area) * middle, 0.03);
  }
  EXPECT_GE(found, 10);
}

}  // namespace
}  // namespace floe
