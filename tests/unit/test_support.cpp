// Supports of structures: the wrench is the gradient of the potential, at any angle.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "forces/support.h"

namespace floe {
namespace {

SupportMatrix random_stiffness(std::mt19937_64& engine) {
  std::uniform_real_distribution<double> part(-1, 1);
  std::array<double, 36> root{};
  for (double& x : root) x = part(engine);
  SupportMatrix k{};
  for (std::size_t row = 0; row < 6; ++row)
    for (std::size_t column = 0; column < 6; ++column)
      for (std::size_t n = 0; n < 6; ++n)
        k[6 * row + column] += root[6 * row + n] * root[6 * column + n];
  return k;
}

/// A motion by a small shift and turn changes the potential by minus its work.
TEST(Support, WrenchIsTheGradientOfItsPotential) {
  std::mt19937_64 engine(7);
  std::uniform_real_distribution<double> part(-1, 1);
  for (const double angle : {0.0, 1e-6, 0.01, 0.049, 0.051, 0.1, 0.5, 1.0, 2.5}) {
    const SupportMatrix k = random_stiffness(engine);
    const Vec3<double> shift{part(engine), part(engine), part(engine)};
    Vec3<double> axis{part(engine), part(engine), part(engine)};
    axis = (1 / length(axis)) * axis;
    const Vec3<double> turn = angle * axis;
    const SupportWrench wrench = springs_of(k, shift, turn);
    constexpr double step = 1e-5;
    for (std::size_t c = 0; c < 3; ++c) {
      Vec3<double> d{};
      d[c] = step;
      const double along =
          (spring_energy(k, shift + d, turn) - spring_energy(k, shift - d, turn)) / (2 * step);
      EXPECT_NEAR(wrench.force[c], -along, 1e-8);
      const auto turned = [&](double sign) {
        return log_rotation(product(exp_rotation(sign * d), exp_rotation(turn)));
      };
      const double about =
          (spring_energy(k, shift, turned(1)) - spring_energy(k, shift, turned(-1))) / (2 * step);
      EXPECT_NEAR(wrench.moment[c], -about, 1e-8) << angle;
    }
  }
}

TEST(Support, IsLinearWhereItIsSmall) {
  std::mt19937_64 engine(8);
  const SupportMatrix k = random_stiffness(engine);
  const Vec3<double> shift{1e-3, 2e-3, -1e-3}, turn{1e-10, -2e-10, 3e-10};
  const SupportWrench wrench = springs_of(k, shift, turn);
  for (std::size_t c = 0; c < 3; ++c) {
    double force = 0, moment = 0;
    for (std::size_t n = 0; n < 3; ++n) {
      force -= k[6 * c + n] * shift[n] + k[6 * c + 3 + n] * turn[n];
      moment -= k[6 * (3 + c) + n] * shift[n] + k[6 * (3 + c) + 3 + n] * turn[n];
    }
    EXPECT_NEAR(wrench.force[c], force, 1e-15);
    EXPECT_NEAR(wrench.moment[c], moment, 1e-11);
  }
}

}  // namespace
}  // namespace floe
