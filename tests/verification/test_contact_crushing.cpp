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

/// A cube that falls on its corner, frictionless.
struct Fall {
  Scene scene = contact_scene(1e8, 0, 1);
  Lattice lattice;
  explicit Fall(const PlasticLimit& limit, bool wear = true) {
    scene.contact.plastic_limit = limit;
    scene.contact.wear = wear;
    append_obstacle(scene, "floor", half_space({0, 0, 0}, {0, 0, 1}));
    const Quat<double> on_edge = exp_rotation({0, 0.25 * std::numbers::pi, 0});
    const Quat<double> on_corner = product(exp_rotation({std::atan(std::sqrt(0.5)), 0, 0}), on_edge);
    append_block(lattice, {1, 1, 1}, {0, 0, std::sqrt(0.75) + 0.1}, on_corner, {0, 0, -1});
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

/// The first impact crushes; the second, which is no faster, meets what is left and gives all
/// back. Without wear the corner heals and crushes again.
TEST(Crushing, IsPaidOnce) {
  for (const ContactLaw law : {ContactLaw::overlap, ContactLaw::potential}) {
    for (const bool wear : {true, false}) {
      Fall fall({.pressure = 2e6}, wear);
      fall.scene.contact.law = law;
      test::Dynamics d(fall.scene, fall.lattice);
      (void)start(d, 0.2);
      const double before = 0.5 * 920 * (1 + 2 * g * 0.1);  // where it touches first
      const After first = impact(d);
      EXPECT_GT(first.crushing, 0.3 * before);
      const After second = impact(d);
      if (wear) {
        EXPECT_NEAR(second.crushing, first.crushing, 0.02 * first.crushing);
      } else {
        EXPECT_GT(second.crushing, first.crushing + 0.3 * first.kinetic);
      }
    }
  }
}

/// A limit that is never reached changes no bit.
TEST(Crushing, CostsNothingWhereNothingIsCrushed) {
  Fall hard({}), limited({.pressure = 1e14, .exponent = 0.5, .fast = 0.5, .speed = 1});
  test::Dynamics a(hard.scene, hard.lattice), b(limited.scene, limited.lattice);
  for (auto* d : {&a, &b}) {
    (void)start(*d, 0.2);
    d->steps(2000);
  }
  EXPECT_LT(velocity(a, 0).z, 0);
  (void)test::expect_same_bits(a, b);
}

/// Cubes slide on planes above and below still water.
TEST(Friction, MayBeAnotherBelowTheWater) {
  for (const double level : {1.0, -3.0}) {
    Scene scene = contact_scene(1e8, 0.3, 0.45);
    scene.contact.friction_wet = 0.1;
    append_obstacle(scene, "floor", half_space({0, 0, level}, {0, 0, 1})).friction_wet = 0.1;
    Lattice lattice;
    append_block(lattice, {1, 1, 0.2}, {0, 0, level + 0.1 - 920 * 0.2 * g * 0.5 * std::cbrt(0.2) / 1e8},
                 {1, 0, 0, 0}, {2, 0, 0});
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
