// Motions of obstacles: rates are derivatives, values are those of the formula.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "floe/contact/obstacle_motion.h"

namespace floe {
namespace {

constexpr double pi = std::numbers::pi;

void expect_near(const Vec3<double>& a, const Vec3<double>& b, double tolerance) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(a.z, b.z, tolerance);
}

ObstacleMotion every_part(double ramp) {
  return {.velocity = {0.3, -0.7, 0.2},
          .angular_velocity = {0.4, 1.1, -0.6},
          .amplitude = {0.05, 0.2, -0.1},
          .frequency = 0.7,
          .ramp = {ramp}};
}

TEST(ObstacleMotion, RatesAreDerivatives) {
  for (const double ramp : {0.0, 2.0}) {
    const ObstacleMotion m = every_part(ramp);
    for (const double t : {0.3, 1.2, 1.9, 2.1, 7.7}) {
      constexpr double h = 1e-5;
      expect_near(m.rate(t), (0.5 / h) * (m.way(t + h) - m.way(t - h)), 1e-9);
      expect_near(m.spin(t),
                  (0.5 / h) * log_rotation(product(m.turn(t + h), conjugate(m.turn(t - h)))), 1e-9);
    }
  }
}

TEST(ObstacleMotion, RisesAndStays) {
  const ObstacleMotion m{.velocity = {1, 2, 3},
                         .angular_velocity = {0, 0, 0.25 * pi},
                         .amplitude = {0.5, 0, 0},
                         .frequency = 0.25,
                         .ramp = {2}};
  expect_near(m.way(0), {0, 0, 0}, 0);
  expect_near(m.rate(0), {0, 0, 0}, 0);
  expect_near(m.way(1), {0.25 + 0.5 * 0.5, 0.5, 0.75}, 1e-15);  // sin(pi/2), half risen
  expect_near(m.way(3), {2 - 0.5, 4, 6}, 1e-14);                // sin(3 pi/2)
  expect_near(m.rate(4), {1 + 0.25 * pi, 2, 3}, 1e-14);
  expect_near(m.spin(1), {0, 0, 0.125 * pi}, 1e-15);
  expect_near(rotate(m.turn(3), {1, 0, 0}), {0, 1, 0}, 1e-15);  // a right angle after 3 s
}

TEST(ObstacleMotion, IsAtRestUnlessSomethingIsGiven) {
  EXPECT_TRUE((ObstacleMotion{.ramp = {1}}.at_rest()));
  EXPECT_FALSE((ObstacleMotion{.velocity = {0, 0, 1}}.at_rest()));
  EXPECT_FALSE((ObstacleMotion{.angular_velocity = {0, 1, 0}}.at_rest()));
  EXPECT_FALSE((ObstacleMotion{.amplitude = {1, 0, 0}, .frequency = 1}.at_rest()));
  expect_near(ObstacleMotion{}.way(3), {0, 0, 0}, 0);
  EXPECT_EQ(ObstacleMotion{}.turn(3).w, 1);
  // A steady motion has no ramp.
  expect_near(ObstacleMotion{.velocity = {1, 0, -2}}.way(0.3), {0.3, 0, -0.6}, 0);
}

/// The list of pairs of contacts rests on this.
TEST(ObstacleMotion, NoPointIsFaster) {
  constexpr double radius = 1.7;
  for (const double ramp : {0.0, 0.01, 0.5, 3.0}) {
    const ObstacleMotion m = every_part(ramp);
    double fastest = 0;
    for (double t = 0.001; t < 6; t += 0.003) {
      const Vec3<double> v = m.rate(t), w = m.spin(t);
      fastest = std::max(fastest, std::sqrt(dot(v, v)) + radius * std::sqrt(dot(w, w)));
    }
    EXPECT_LT(fastest, m.largest_speed(radius));
    EXPECT_GT(fastest, 0.5 * m.largest_speed(radius));
  }
}

}  // namespace
}  // namespace floe
