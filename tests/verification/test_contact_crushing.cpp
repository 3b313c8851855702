// Crushing in motion (model.md, "Contact"): wear, energies, wet and dry friction.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "support/contact_scene.h"

namespace floe {
namespace {

using test::append_block;
using test::append_obstacle;
using test::contact_scene;
using test::start;
using test::velocity;

constexpr double g = 9.81;

/// A cube that flies onto a floor, its corner ahead, without friction and gravity.
struct Impact {
  Scene scene = contact_scene(1e8, 0, 1, false);
  Lattice lattice;
  double speed;
  Impact(double towards, const PlasticLimit& limit) : speed(towards) {
    scene.contact.plastic_limit = limit;
    append_obstacle(scene, "floor", half_space({0, 0, 0}, {0, 0, 1}));
    const Quat<double> on_edge = exp_rotation({0, 0.25 * std::numbers::pi, 0});
    const Quat<double> on_corner =
        product(exp_rotation({std::atan(std::sqrt(0.5)), 0, 0}), on_edge);
    append_block(lattice, {1, 1, 1}, {0, 0, std::sqrt(0.75) + 0.01 * speed}, on_corner,
                 {0, 0, -speed});
  }
};

/// Energies after an impact [J].
struct After {
  double kinetic = 0, crushing = 0;
};
After impact(test::Dynamics& d) {
  while (d.reported("contacts") == 0) d.steps(1);
  while (d.reported("contacts") > 0) d.steps(1);
  return {d.kinetic(), d.reported("energy_crushing")};
}

/// The first impact crushes; a second one at the speed with which it comes back meets what is left
/// and gives all back. Without wear the corner heals and crushes again.
TEST(Crushing, IsPaidOnce) {
  for (const ContactLaw law : {ContactLaw::overlap, ContactLaw::potential}) {
    for (const bool wear : {true, false}) {
      Impact cube = law == ContactLaw::overlap ? Impact(1.5, {.pressure = 2e6})
                                               : Impact(0.3, {.pressure = 2e4});
      cube.scene.contact.law = law;
      cube.scene.contact.wear = wear;
      test::Dynamics d(cube.scene, cube.lattice);
      (void)start(d, 0.2);
      const double before = 0.5 * 920 * cube.speed * cube.speed;
      const After first = impact(d);
      EXPECT_GT(first.crushing, 0.5 * before);
      EXPECT_NEAR(first.kinetic + first.crushing, before, 1e-3 * before);
      d.state().record(0)[9] = -velocity(d, 0).z;
      const After second = impact(d);
      if (wear) {
        EXPECT_NEAR(second.crushing, first.crushing, 0.01 * first.kinetic);
        EXPECT_NEAR(second.kinetic, first.kinetic, 0.01 * first.kinetic);
      } else if (law == ContactLaw::overlap) {
        // `potential` stores 1/2 sigma_p^2 A_r/k_v before it crushes, which is all that came back.
        EXPECT_GT(second.crushing, first.crushing + 0.3 * first.kinetic);
      }
    }
  }
}

/// A limit that is never reached changes no bit.
TEST(Crushing, CostsNothingWhereNothingIsCrushed) {
  Impact hard(1, {}), limited(1, {.pressure = 1e14, .exponent = 0.5, .fast = 0.5, .speed = 1});
  test::Dynamics a(hard.scene, hard.lattice), b(limited.scene, limited.lattice);
  for (auto* d : {&a, &b}) {
    (void)start(*d, 0.2);
    (void)impact(*d);
  }
  EXPECT_NEAR(velocity(a, 0).z, 1, 1e-3);
  (void)test::expect_same_bits(a, b);
}

/// Cubes slide on planes above and below still water.
TEST(Friction, MayBeAnotherBelowTheWater) {
  for (const double level : {1.0, -3.0}) {
    Scene scene = contact_scene(1e8, 0.3, 0.45);
    scene.contact.friction_wet = 0.1;
    append_obstacle(scene, "floor", half_space({0, 0, level}, {0, 0, 1})).friction_wet = 0.1;
    Lattice lattice;
    append_block(lattice, {1, 1, 0.2},
                 {0, 0, level + 0.1 - 920 * 0.2 * g * 0.5 * std::cbrt(0.2) / 1e8}, {1, 0, 0, 0},
                 {2, 0, 0});
    test::Dynamics d(scene, lattice);
    const double dt = start(d);
    d.steps(static_cast<long>(0.2 / dt));
    const double mu = level > 0 ? 0.3 : 0.1;
    EXPECT_NEAR(velocity(d, 0).x, 2 - mu * g * 0.2, 0.01 * mu * g * 0.2) << level;
  }
}

/// Between bodies too: of two plates, one on the other, the upper one slides.
TEST(Friction, OfBodiesMayBeAnotherBelowTheWater) {
  for (const double level : {1.0, -3.0}) {
    Scene scene = contact_scene(1e8, 0.3, 0.45);
    scene.contact.friction_wet = 0.1;
    append_obstacle(scene, "floor", half_space({0, 0, level}, {0, 0, 1})).friction = 10;
    Lattice lattice;
    append_block(lattice, {4, 4, 0.2}, {0, 0, level + 0.1});
    append_block(lattice, {1, 1, 0.2}, {-1, 0, level + 0.3}, {1, 0, 0, 0}, {2, 0, 0});
    test::Dynamics d(scene, lattice);
    const double dt = start(d);
    d.steps(static_cast<long>(0.2 / dt));
    const double mu = level > 0 ? 0.3 : 0.1;
    EXPECT_NEAR(velocity(d, 1).x, 2 - mu * g * 0.2, 0.03 * mu * g * 0.2) << level;
  }
}

}  // namespace
}  // namespace floe
