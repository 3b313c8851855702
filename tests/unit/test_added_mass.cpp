// Added mass by direction: Kirchhoff's equations of a free body, the flat plate, and what moves
// with it.
#include "water/added_mass.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/box.h"
#include "support/dynamics.h"

namespace floe {
namespace {

constexpr double pi = 3.14159265358979323846;

/// A box in still water that nothing else acts on.
Scene only_water() {
  Scene scene;
  scene.water_density = 1000;
  return scene;
}

/// A free tumbling body keeps its energy, its impulse and its moment of impulse, which
/// a = R M^-1 R^T F without the moment of Munk does not.
TEST(AddedMass, AFreeTumblingBodyKeepsItsEnergy) {
  const Lattice lattice = test::box({2, 1.2, 0.5}, 920, -20, {0.8, -0.5, 0.6}, {0.9, 1.3, -0.7});
  Scene scene = only_water();
  scene.added_mass_axes = {0.1, 0.3, 1.5, 0.8, 0.4, 0.05};
  double last = 0;
  for (const double dt : {1e-3, 5e-4}) {
    test::Dynamics run(scene, lattice);
    run.set_step(dt);
    const double energy = run.kinetic();
    const std::array<double, 6> momentum = run.momentum();
    double worst = 0, turned = 0;
    for (int n = 0; n < 20 / dt; ++n) {
      run.steps(1);
      worst = std::max(worst, std::abs(run.kinetic() / energy - 1));
      turned = std::max(turned, 1 - std::abs(rotation(run.state(), 0).w));
    }
    EXPECT_GT(turned, 0.9);
    const std::array<double, 6> now = run.momentum();
    double size = 0, miss = 0;
    for (std::size_t k = 0; k < 6; ++k)
      size = std::max(size, std::abs(momentum[k])),
      miss = std::max(miss, std::abs(now[k] - momentum[k]));
    EXPECT_LT(miss, 1e-6 * size);
    EXPECT_LT(worst, 1e-6);
    if (last > 0) {
      EXPECT_NEAR(last / worst, 4, 0.5);  // second order
    }
    last = worst;
  }
}

/// Munk's moment turns a body that moves at an angle to its axes broadside: the angular
/// acceleration at first is (M_3 - M_1) v_1 v_3/I about axis 2 (v x p has the component v_3 p_1 -
/// v_1 p_3 there).
TEST(AddedMass, MunksMoment) {
  const Lattice lattice = test::box({2, 2, 0.5}, 1000, -20, {0.3, 0, 0.2});
  Scene scene = only_water();
  scene.added_mass_axes = {0, 0, 2, 0, 1, 0};
  test::Dynamics run(scene, lattice);
  const double dt = 1e-3;
  run.set_step(dt);
  run.steps(10);
  const double mass = lattice.bodies.mass[0], inertia = 2 * lattice.bodies.inertia[0].y;
  const double moment = -(0.2 * mass * 0.3 - 0.3 * 3 * mass * 0.2);
  EXPECT_NEAR(angular_velocity(run.state(), 0).y / (moment / inertia * 10 * dt), 1, 1e-4);
  EXPECT_GT(moment, 0);  // e3 turns towards +x, the way the body goes: it turns broadside
}

/// Heave with added mass along axis 3, roll with added moment: periods by hand.
TEST(AddedMass, SlowsHeaveAndRoll) {
  const double a = 2, h = 0.5, density = 500, rho = 1000;
  const double mass = density * a * a * h;
  Scene scene = only_water();
  scene.forces.gravity = scene.forces.buoyancy = true;
  scene.added_mass_plate = true;
  const double radius = a / std::sqrt(pi);
  const double heavy = mass + 4.0 / 3.0 * rho * std::pow(radius, 3);
  const double inertia = mass * (a * a + h * h) / 12 + 8.0 / 45.0 * rho * std::pow(radius, 5);
  // Waterplane stiffness; roll: rho g (I + V (z_B - z_G)), z_B a quarter of h below the centroid.
  const double heave = rho * 9.81 * a * a;
  const double roll = rho * 9.81 * (std::pow(a, 4) / 12 - a * a * h / 2 * h / 4);
  for (const bool turns : {false, true}) {
    const Lattice lattice = test::box({a, a, h}, density, 0, turns ? Point3{} : Point3{0, 0, 0.01},
                                      turns ? Point3{0.01, 0, 0} : Point3{});
    test::Dynamics run(scene, lattice);
    const double dt = 5e-4;
    run.set_step(dt);
    std::vector<double> passages;
    double before = 0;
    for (int n = 0; passages.size() < 6 && n < 100000; ++n) {
      run.steps(1);
      const double now = turns ? 2 * rotation(run.state(), 0).x : displacement(run.state(), 0).z;
      if (before < 0 && now >= 0) passages.push_back(run.state().time - dt * now / (now - before));
      before = now;
    }
    ASSERT_EQ(passages.size(), 6U);
    const double omega = turns ? std::sqrt(roll / inertia) : std::sqrt(heave / heavy);
    EXPECT_NEAR((passages[5] - passages[0]) / 5 * omega / (2 * pi), 1, 2e-4) << turns;
  }
}

/// The disc is the limit of an oblate spheroid (Lamb 1932, sections 114 and 115): twice the
/// plate's.
TEST(AddedMass, ThePlateIsHalfOfAFlatSpheroid) {
  const double a = 1.3, c = 1e-4 * a, e = std::sqrt(1 - c * c / (a * a)), rho = 1000;
  const double gamma = 2 / (e * e) * (1 - std::sqrt(1 - e * e) * std::asin(e) / e);
  const double alpha = std::sqrt(1 - e * e) / (e * e * e) * std::asin(e) - (1 - e * e) / (e * e);
  const double fluid = 4.0 / 3.0 * pi * rho * a * a * c;
  const double along = gamma / (2 - gamma) * fluid;
  const double a2 = a * a, c2 = c * c, b2 = a2 - c2;
  const double about =
      fluid / 5 * b2 * b2 * (gamma - alpha) / (2 * b2 + (a2 + c2) * (alpha - gamma));
  const double side = a * std::sqrt(pi);
  const Lattice lattice = test::box({side, side, 0.1}, 900, 0, {});
  const Part part = partition(lattice, PETSC_COMM_SELF);
  const std::vector<AddedAlongAxes> plate = added_of_plates(part, rho);
  EXPECT_NEAR(2 * plate[0].mass.z / along, 1, 1e-3);
  EXPECT_NEAR(2 * plate[0].moment.x / std::abs(about), 1, 1e-3);
  EXPECT_EQ(plate[0].moment.x, plate[0].moment.y);
  EXPECT_EQ(plate[0].moment.z, 0);
  EXPECT_EQ(plate[0].mass.x, 0);
}

/// Equal parts in all directions are added_mass as before, but for rounding.
TEST(AddedMass, EqualPartsAreAFraction) {
  const Lattice lattice = test::box({2, 1.2, 0.5}, 920, 0, {0.3, 0.1, 0.2}, {0.2, 0.3, -0.1});
  Scene scene = only_water();
  scene.forces.gravity = scene.forces.buoyancy = true;
  Scene other = scene;
  scene.added_mass = 0.7;
  other.added_mass_axes = {0.7, 0.7, 0.7, 0, 0, 0};
  test::Dynamics one(scene, lattice), two(other, lattice);
  for (auto* run : {&one, &two}) run->set_step(1e-3), run->steps(2000);
  for (std::size_t k = 0; k < 3; ++k)
    EXPECT_NEAR(one.state().record(0)[k], two.state().record(0)[k], 1e-12);
  EXPECT_NEAR(one.kinetic(), two.kinetic(), 1e-9);
}

}  // namespace
}  // namespace floe
