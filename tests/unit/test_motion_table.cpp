// Motions by tables, of obstacles, boundaries and anchors.
#include <gtest/gtest.h>

#include <cmath>

#include "floe/contact/obstacle_motion.h"
#include "floe/forces/boundary.h"
#include "floe/forces/mooring_line.h"

namespace floe {
namespace {

void expect_near(const Vec3<double>& a, const Vec3<double>& b, double tolerance) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(a.z, b.z, tolerance);
}

/// Displacement along x, velocity along z, and a rotation vector whose direction changes.
MotionTable tumbling() {
  const TimeTable table({{0, 0, 0, 0, 0, 0},
                         {1, 1, 2, 0.4, -0.3, 0.1},
                         {2.5, -1, 1, 1.5, 0.8, -0.6},
                         {4, 0, 1, 0.2, 2.1, 0.3},
                         {5, 0, 1, 0, 0, 0}},
                        TimeTable::Interpolation::smooth, false);
  MotionTable motion{.table = table};
  motion.columns[0] = {0, false};
  motion.columns[2] = {1, true};
  for (std::int32_t k = 0; k < 3; ++k)
    motion.columns[static_cast<std::size_t>(3 + k)] = {2 + k, false};
  return motion;
}

TEST(MotionTable, RatesAreDerivatives) {
  const ObstacleMotion m{.table = tumbling()};
  constexpr double h = 1e-5;
  for (const double t : {0.3, 0.7, 1.4, 2.2, 3.1, 4.6, 5.5}) {
    expect_near(m.rate(t), (0.5 / h) * (m.way(t + h) - m.way(t - h)), 1e-8);
    expect_near(m.spin(t),
                (0.5 / h) * log_rotation(product(m.turn(t + h), conjugate(m.turn(t - h)))), 1e-8);
    for (const std::size_t k : {0U, 2U, 4U})
      EXPECT_NEAR(m.table.acceleration(k, t),
                  (0.5 / h) * (m.table.rate(k, t + h) - m.table.rate(k, t - h)), 1e-8);
  }
  EXPECT_EQ(m.way(1).x, 1);
  EXPECT_EQ(m.rate(1).z, 2);
  EXPECT_EQ(m.way(3).y, 0);
  EXPECT_FALSE(m.at_rest());
}

TEST(MotionTable, SpinOfSmallRotations) {
  const Vec3<double> direction{0.6, -0.5, 0.3}, rate{1, 2, -3};
  for (const double size : {0.0, 1e-9, 1e-4, 0.9e-2, 1.1e-2, 0.3}) {
    const Vec3<double> turn = size * direction;
    constexpr double h = 1e-6;
    const auto q = [&](double t) { return exp_rotation(turn + t * rate); };
    expect_near(spin_of(turn, rate), (0.5 / h) * log_rotation(product(q(h), conjugate(q(-h)))),
                1e-8);
  }
}

/// The list of pairs of contacts rests on this.
TEST(MotionTable, NoPointIsFaster) {
  const ObstacleMotion m{.table = tumbling()};
  constexpr double radius = 1.7;
  double fastest = 0;
  for (double t = 0; t < 6; t += 1e-3)
    fastest = std::max(fastest, length(m.rate(t)) + radius * length(m.spin(t)));
  EXPECT_LT(fastest, m.largest_speed(radius));
  EXPECT_GT(fastest, 0.5 * m.largest_speed(radius));
}

TEST(MotionTable, OfABoundaryAndAnAnchor) {
  Boundary boundary;
  boundary.table = tumbling();
  boundary.fixed = {true, true, true, false, true, false};
  EXPECT_EQ(boundary.value(1), (std::array<double, 6>{1, 0, boundary.table.way(1).z, 0, -0.3, 0}));
  EXPECT_GT(boundary.table.way(1).z, 0.9);
  EXPECT_EQ(boundary.rate(1)[2], 2);
  EXPECT_EQ(boundary.acceleration(1)[2], boundary.table.acceleration(2, 1));

  MooringLine line;
  line.anchor = {1, 2, 3};
  EXPECT_FALSE(line.moves());
  expect_near(line.anchor_at(7), {1, 2, 3}, 0);
  line.anchor_velocity = {1, 0, -2}, line.anchor_ramp = {2};
  expect_near(line.anchor_at(3), {3, 2, -1}, 1e-15);
  expect_near(line.anchor_velocity_at(1), {0.5, 0, -1}, 1e-15);
  line.anchor_table = tumbling();
  EXPECT_TRUE(line.moves());
  expect_near(line.anchor_at(1), {2, 2, 3 + line.anchor_table.way(1).z}, 1e-15);
  expect_near(line.anchor_velocity_at(1), line.anchor_table.velocity(1), 0);
}

}  // namespace
}  // namespace floe
