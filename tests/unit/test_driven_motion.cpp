// Motions that a program gives piece by piece.
#include "floe/base/driven_motion.h"

#include <gtest/gtest.h>

#include <cmath>

namespace floe {
namespace {

void expect_near(const Vec3<double>& a, const Vec3<double>& b, double tolerance) {
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(a[k], b[k], tolerance);
}

/// Rotation vector from one rotation to another.
Vec3<double> between(const Quat<double>& from, const Quat<double>& to) {
  return log_rotation(normalised(product(to, conjugate(from))));
}

const DrivenMotion motion{
    .from = 2,
    .until = 2.5,
    .start = {.way = {1, 2, 3},
              .turn = exp_rotation({0.3, -0.2, 0.1}),
              .rate = {0.5, -1, 2},
              .spin = {1, 0.5, -0.7}},
    .end = {.way = {1.2, 1.7, 3.5},
            .turn = exp_rotation({0.6, 0.2, -0.4}),
            .rate = {-0.3, 0.1, 0.4},
            .spin = {-0.2, 1.1, 0.3}},
};

TEST(DrivenMotion, MeetsItsEnds) {
  for (const auto& [time, place] : {std::pair{2.0, motion.start}, {2.5, motion.end}}) {
    for (const double beside : {-1e-13, 0.0, 1e-13}) {
      const DrivenMotion::Place at = motion.at(time + beside);
      expect_near(at.way, place.way, 1e-12);
      expect_near(between(place.turn, at.turn), {}, 1e-12);
      expect_near(at.rate, place.rate, 1e-11);
      expect_near(at.spin, place.spin, 1e-11);
    }
  }
}

TEST(DrivenMotion, RatesAreThoseOfThePlaces) {
  constexpr double h = 1e-6;
  for (const double time : {1.7, 2.1, 2.25, 2.4, 2.9}) {
    const DrivenMotion::Place before = motion.at(time - h), after = motion.at(time + h),
                              now = motion.at(time);
    expect_near((0.5 / h) * (after.way - before.way), now.rate, 1e-8);
    expect_near((0.5 / h) * between(before.turn, after.turn), now.spin, 1e-8);
  }
}

TEST(DrivenMotion, IsACubicInTime) {
  // x = t^3 - 2 t from 0 to 2
  const DrivenMotion cubic{.from = 0,
                           .until = 2,
                           .start = {.way = {0, 0, 0}, .rate = {-2, 0, 0}},
                           .end = {.way = {4, 0, 0}, .rate = {10, 0, 0}}};
  for (const double t : {0.3, 1.0, 1.9}) {
    EXPECT_NEAR(cubic.at(t).way.x, t * t * t - 2 * t, 1e-14);
    EXPECT_NEAR(cubic.at(t).rate.x, 3 * t * t - 2, 1e-14);
  }
  EXPECT_NEAR(cubic.at(3).way.x, 14, 1e-14);  // and goes on
  EXPECT_NEAR(cubic.at(-1).way.x, 2, 1e-14);
}

TEST(DrivenMotion, BoundsItsSpeed) {
  constexpr double radius = 3;
  double most = 0;
  for (double time = 1; time < 4; time += 1e-3) {
    const DrivenMotion::Place at = motion.at(time);
    most = std::max(most, length(at.rate) + radius * length(at.spin));
  }
  EXPECT_GE(motion.largest_speed(radius), most);
  EXPECT_LE(motion.largest_speed(radius), 6 * most);
}

TEST(DrivenMotion, AtOnceHoldsItsEndAtAllTimes) {
  const DrivenMotion at_once{.from = 1,
                             .until = 1,
                             .start = {},
                             .end = {.way = {1, 0, 0}, .rate = {0, 2, 0}, .spin = {0, 0, 3}}};
  for (const double time : {0.5, 1.0, 2.0}) {
    expect_near(at_once.at(time).way, {1, 2 * (time - 1), 0}, 1e-15);
    expect_near(log_rotation(at_once.at(time).turn), {0, 0, 3 * (time - 1)}, 1e-14);
  }
}

}  // namespace
}  // namespace floe
