// model: rotational_inertia_factor: moments of inertia of all bodies times 1 to 4.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "contact/solids.h"
#include "scene_model/scene_model.h"
#include "support/box.h"
#include "support/contact_scene.h"
#include "support/scene_options.h"

namespace floe {
namespace {

using InertiaKey = SceneOptions;

constexpr auto moving = "integrator: explicit\nforces: [beam]\nsheet: {length: 40}\n";

TEST_F(InertiaKey, IsOfExplicitDynamicsFromOneToFour) {
  const auto with = [](const std::string& value) {
    return moving + ("model: {rotational_inertia_factor: " + value + "}\n");
  };
  EXPECT_EQ(scene_of(moving).inertia_factor, 1);
  EXPECT_EQ(scene_of(with("2.5")).inertia_factor, 2.5);
  EXPECT_EQ(scene_of(with("4")).inertia_factor, 4);
  for (const std::string value : {"0.5", "4.01", "-1"}) {
    const std::string error = scene_error(with(value));
    EXPECT_TRUE(contains(error, "model: rotational_inertia_factor")) << error;
    EXPECT_TRUE(contains(error, value)) << error;
    EXPECT_TRUE(contains(error, ">= 1, <= 4")) << error;
  }
  const std::string key = "model: {rotational_inertia_factor: 2}\n";
  EXPECT_TRUE(contains(error_with(key), "'integrator' is quasistatic"));
  const std::string implicit =
      scene_error("integrator: implicit\nforces: [beam]\nsheet: {length: 40}\n" + key);
  EXPECT_TRUE(contains(implicit, "any step is stable")) << implicit;
}

/// Of a small sheet that floats.
Scene sheet_scene(double factor) {
  Scene scene;
  scene.integrator = Integrator::explicit_;
  scene.has_sheet = true;
  scene.forces.beam = scene.forces.gravity = scene.forces.buoyancy = true;
  scene.sheet.length = scene.sheet.width = 8;
  scene.sheet.element_size = 2;
  scene.inertia_factor = factor;
  return scene;
}

Lattice sheet_of(const Scene& scene) {
  MeshReport report;
  return make_lattice(scene, PETSC_COMM_SELF, report);
}

TEST(RotationalInertia, MultipliesTheMomentsOfBodiesAndNothingElse) {
  const Lattice one = sheet_of(sheet_scene(1)), three = sheet_of(sheet_scene(3));
  ASSERT_GT(one.bodies.size(), 10);
  for (std::size_t b = 0; b < one.bodies.inertia.size(); ++b) {
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_EQ(three.bodies.inertia[b][k], 3 * one.bodies.inertia[b][k]);
  }
  EXPECT_EQ(three.bodies.mass, one.bodies.mass);
  EXPECT_EQ(three.bodies.position, one.bodies.position);
  EXPECT_EQ(three.beams.inertia_y, one.beams.inertia_y);  // of sections
}

/// Contacts move bodies as the beams do: what they take from shapes is what the lattice has.
TEST(RotationalInertia, OfContactsIsThatOfTheLattice) {
  const Lattice lattice = sheet_of(sheet_scene(4));
  const Solids solids(lattice.shapes, lattice.bodies.mass, {}, 4);
  for (std::int32_t b = 0; b < lattice.bodies.size(); ++b) {
    const InverseInertia inverse = solids.inverse_inertia(b);
    EXPECT_EQ(inverse.mass, 1 / item(lattice.bodies.mass, b));
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_NEAR(inverse.moments[k] * item(lattice.bodies.inertia, b)[k], 1, 1e-9);
  }
}

/// The water that a body takes along turns with the moments that it has without the factor.
TEST(RotationalInertia, LeavesAddedMomentsOfTheWater) {
  std::array<Point3, 2> moments;
  std::array<double, 2> mass{};
  for (const int k : {0, 1}) {
    Scene scene = sheet_scene(k == 0 ? 1 : 4);
    scene.added_mass_axes = {0.1, 0.2, 1, 0.5, 0.6, 0.7};
    test::Dynamics run(scene, sheet_of(scene));
    const auto& added = run.model().added_inertia().at(3);
    moments.at(static_cast<std::size_t>(k)) = {added.moment.x, added.moment.y, added.moment.z};
    mass.at(static_cast<std::size_t>(k)) = added.mass.z;
  }
  EXPECT_EQ(mass[0], mass[1]);
  EXPECT_GT(moments[0].x, 0);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(moments[1][k] / moments[0][k], 1, 1e-15);
}

/// What a body that falls on one of its corners has after the impact.
struct After {
  double approach;  ///< speed of the corner along z, over that before
  double rise;      ///< of the centre [m/s]
  double spin;      ///< about y [rad/s]
  double arm;       ///< horizontal distance of centre and corner [m]
  double inertia;   ///< [kg m^2]
  double mass;      ///< [kg]
};

/// A prism of sides 2, 1, 0.6 m, tilted about y so that its long edge along y falls on a plane.
After impact(double factor, double restitution) {
  Scene scene = test::contact_scene(1e10, 0, restitution, false);
  test::append_obstacle(scene, "floor", half_space({0, 0, 0}, {0, 0, 1}));
  scene.inertia_factor = factor;
  const double tilt = 0.3, speed = 0.1;
  const Quat<double> turn = exp_rotation(Vec3<double>{0, tilt, 0});
  const double arm = 1.0 * std::cos(tilt) - 0.3 * std::sin(tilt);
  const double low = 1.0 * std::sin(tilt) + 0.3 * std::cos(tilt);
  Lattice lattice = test::box({2, 1, 0.6}, 900, low, {0, 0, -speed});
  lattice.bodies.orientation[0] = {turn.w, turn.x, turn.y, turn.z};
  const double mass = lattice.bodies.mass[0], inertia = factor * lattice.bodies.inertia[0].y;
  lattice.bodies.inertia[0] = factor * lattice.bodies.inertia[0];
  test::Dynamics run(scene, lattice);
  run.evaluate();
  // A wedge has no stiffness yet: a hundredth of the period of full depth.
  run.set_step(2e-6);
  run.steps(20000);
  const double* r = run.state().record(0);
  const double rise = r[9], spin = angular_velocity(run.state(), 0).y;
  // The edge lies at +arm along x below the centre: its velocity is v - spin arm along z.
  return {(rise - spin * arm) / speed, rise, spin, arm, inertia, mass};
}

/// An elastic impact on an edge: the corner leaves as fast as it came, by an impulse
/// 2 v/(1/m + a^2/I) with the moment I of the body as multiplied.
TEST(RotationalInertia, DecidesImpactsOnEdges) {
  for (const double factor : {1.0, 4.0}) {
    const After after = impact(factor, 1);
    const double impulse = 2 * 0.1 / (1 / after.mass + after.arm * after.arm / after.inertia);
    EXPECT_NEAR(after.approach, 1, 0.01) << factor;
    EXPECT_NEAR(after.rise, impulse / after.mass - 0.1, 0.001) << factor;
    EXPECT_NEAR(after.spin, -impulse * after.arm / after.inertia, 0.001) << factor;
  }
}

/// Dashpots of contacts go by the mass that the contact moves, so what an impact gives back does
/// not depend on the factor; with the moments of the shapes it would.
TEST(RotationalInertia, LeavesWhatAnImpactGivesBack) {
  const double one = impact(1, 0.3).approach, four = impact(4, 0.3).approach;
  EXPECT_GT(one, 0.1);
  EXPECT_LT(one, 0.7);
  EXPECT_NEAR(four, one, 0.01);
}

}  // namespace
}  // namespace floe
