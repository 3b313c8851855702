// Bodies that contacts must leave alone, or carry afloat: draft, roll stability, free spin; and
// contacts that are born where a beam breaks (model.md, "Contact").

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "contact_force/contact.h"
#include "contact_laws/restitution.h"
#include "explicit/explicit.h"
#include "stability/stable_step.h"
#include "support/blocks.h"
#include "support/dynamics.h"
#include "support/lattices.h"
#include "support/record.h"
#include "support/roles.h"

namespace floe {
namespace {

constexpr double g = 9.81, ice = 920, water = 1010, young = 1e7;

Scene contact_scene(bool afloat) {
  Scene scene;
  scene.integrator = Integrator::explicit_;
  scene.forces.contact = true;
  scene.forces.gravity = scene.forces.buoyancy = scene.forces.drag = afloat;
  scene.drag.linear = afloat ? 2000 : 0;
  scene.contact.young = young;
  scene.contact.friction = 0.3;
  scene.contact.damping_ratio = damping_ratio_of(0.3);
  return scene;
}

/// Steps at half of the stable step up to `time`, calling after each one.
template <class Each>
void run_to(test::Dynamics& d, double time, Each&& each) {
  const double dt = 0.5 * stable_step(d.model(), d.state()).dt;
  d.evaluate();
  d.set_step(dt);
  while (d.state().time < time) {
    (void)d.step();
    each();
  }
}

/// A raft of 4 x 4 x 1 m with a block of 2 x 2 x 0.2 m on it, and a block of its own beside.
TEST(ContactAfloat, DraftsAreThoseOfTheWeights) {
  Lattice lattice;
  const auto height = [](double h) { return h * (0.5 - ice / water); };
  test::append_block(lattice, {4, 4, 1}, {0, 0, height(1)});
  test::append_block(lattice, {2, 2, 0.2}, {0, 0, height(1) + 0.6});
  test::append_block(lattice, {4, 4, 1}, {4.05, 0, height(1) + 0.05});
  test::Dynamics d(contact_scene(true), lattice);
  run_to(d, 40, [] {});
  const auto bottom = [&](std::size_t b, double h) {
    return lattice.bodies.position[b][2] + displacement(d.state(), b).z - 0.5 * h;
  };
  const double load = ice * 2 * 2 * 0.2;  // [kg]
  EXPECT_NEAR(-bottom(0, 1), (ice * 16 + load) / (water * 16), 1e-4);
  EXPECT_NEAR(-bottom(2, 1), ice / water, 1e-4);
  // What presses the two on each other is the upper one's weight.
  const double sunk = bottom(0, 1) + 1 - bottom(1, 0.2);
  const double stiffness = young / (0.5 * (std::cbrt(16.0) + std::cbrt(0.8))) * 4;
  EXPECT_NEAR(sunk * stiffness / (load * g), 1, 1e-3);
}

/// A block of breadth b and height h is upright as long as I/V > z_G - z_B:
/// b/h > sqrt(6 r (1 - r)), r the ratio of densities. A narrower one rolls onto its side.
TEST(ContactAfloat, BlocksRollOverOnlyIfNarrow) {
  const double r = ice / water, limit = std::sqrt(6 * r * (1 - r));
  for (const double part : {0.96, 1.04}) {
    const Vec3<double> size{part * limit, 4, 1};
    Lattice lattice;
    test::append_block(lattice, size, {0, 0, 0.5 - r}, exp_rotation({0, 0.01, 0}));
    test::append_block(lattice, size, {2, 0, 0.5 - r}, exp_rotation({0, -0.01, 0}));
    Scene scene = contact_scene(true);
    scene.drag.linear = 0;
    test::Dynamics d(scene, lattice);
    double most = 0;
    run_to(d, 60,
           [&] { most = std::max(most, std::abs(log_rotation(rotation(d.state(), 0)).y + 0.01)); });
    if (part > 1) {
      EXPECT_LT(most, 0.02);
    } else {
      EXPECT_GT(most, 0.25 * std::numbers::pi);
    }
  }
}

/// Contacts that are looked at and are none do nothing: a body that tumbles between others keeps
/// its angular momentum to the last digits, and its energy as without them.
TEST(ContactFree, SpinningBodyKeepsMomentumAndEnergy) {
  Lattice lattice;
  test::Random random(5);
  const Vec3<double> spin{0.35, 0.9, 0.25};
  for (int k = 0; k < 3; ++k) test::append_stone(lattice, random, {}, random.rotation(1), {}, {});
  lattice.bodies.angular_velocity[0] = spin;
  // As near as spheres around them allow.
  const auto radius = [&](std::int32_t body) {
    double most = 0;
    const auto& of = lattice.shapes.vertex_of;
    const auto b = static_cast<std::size_t>(body);
    for (auto v = static_cast<std::size_t>(of[b]); v < static_cast<std::size_t>(of[b + 1]); ++v) {
      const auto& [x, y, z] = lattice.shapes.vertices[v];
      most = std::max(most, std::sqrt(x * x + y * y + z * z));
    }
    return most;
  };
  constexpr double clear = 1e-3;
  lattice.bodies.position[1] = {radius(0) + radius(1) + clear, 0, 0};
  lattice.bodies.position[2] = {-radius(0) - radius(2) - clear, 0, 0};
  const double deepest = std::max({radius(0), radius(1), radius(2)}) + clear;
  Scene scene = contact_scene(false);
  scene.obstacles = {half_space({0, 0, -deepest}, {0, 0, 1})};
  scene.obstacles[0].name = "floor";
  test::Dynamics d(scene, lattice);
  const std::array<double, 6> before = d.momentum();
  const double energy = d.kinetic();
  d.set_step(0.004);
  double worst = 0;
  for (int n = 0; n < 20000; ++n) {
    (void)d.step();
    if (n % 10 == 0) worst = std::max(worst, std::abs(d.kinetic() / energy - 1));
  }
  EXPECT_EQ(d.reported("contacts"), 0);
  EXPECT_LT(worst, 1e-5);
  EXPECT_EQ(d.momentum(), before);
}

/// Two blocks whose shapes overlap by 5 cm are joined by a beam; sheared and pressed they break it.
/// From then on they touch, with what they overlap by as plastic: nothing is added to the energy.
TEST(ContactOfBrokenBeams, AddsNoEnergy) {
  Lattice lattice;
  constexpr double apart = 0.95, speed = 2;
  test::append_block(lattice, {1, 1, 1}, {0, 0, 0}, {1, 0, 0, 0}, {0.2, 0, -0.5 * speed});
  test::append_block(lattice, {1, 1, 1}, {apart, 0, 0}, {1, 0, 0, 0}, {-0.2, 0, 0.5 * speed});
  Beams& b = lattice.beams;
  b.bodies = {{0, 1}};
  b.area = {1}, b.width = {1}, b.height = {1}, b.length = {apart};
  b.inertia_y = b.inertia_z = {1.0 / 12}, b.torsion = {saint_venant_torsion(1, 1)};
  b.young = {1e8}, b.shear_modulus = {4e7}, b.shear_factor = {5.0 / 6}, b.axis_y = {{0, 1, 0}};
  Scene scene = contact_scene(false);
  scene.forces.beam = scene.forces.fracture = true;
  scene.fracture.tensile_strength = scene.fracture.shear_strength = 1e5;
  scene.contact.damping_ratio = scene.contact.friction = 0;
  Model<Spatial> model(lattice, PETSC_COMM_SELF, {});
  add_forces(scene, {}, model, &lattice);
  add_contact(scene, lattice, model);
  ExplicitOptions options;
  options.end = 0.08, options.dt = 2e-5, options.history = 2e-5;
  double at_birth = -1, most = 0, worst = 0, kinetic = 0, touched = 0;
  const RunResult result = run_explicit(model, options, [&](const Accepted<Spatial>& a) {
    double broken = 0, stored = 0, error = 0, contacts = 0;
    for (const auto* list : {&a.columns, &a.forces}) {
      for (const auto& [name, value] : *list) {
        if (name == "beams_broken") broken = value;
        if (name == "energy_contact") stored = value;
        if (name == "energy_balance_error") error = std::abs(value);
        if (name == "energy_kinetic") kinetic = std::max(kinetic, value);
        if (name == "contacts") contacts = value;
      }
    }
    if (broken == 0) {
      EXPECT_EQ(contacts, 0);  // a beam joins them
      return;
    }
    if (at_birth < 0) at_birth = stored;
    touched = std::max(touched, contacts);
    most = std::max(most, stored);
    worst = std::max(worst, error);
  });
  EXPECT_TRUE(result.done) << result.message;
  EXPECT_GE(at_birth, 0) << "the beam must break";
  EXPECT_LT(at_birth, 1e-9 * kinetic);
  EXPECT_EQ(touched, 1);
  EXPECT_GT(most, 1e-4 * kinetic);  // they were pressed on
  // The overlap itself would store 0.5 k_v V^2/|S|.
  EXPECT_LT(most, 0.1 * 0.5 * young * 0.05 * 0.05);
  EXPECT_LT(worst, 1e-4 * kinetic);
}

/// In a block of 3 x 3 x 2 boxes the two in the middle have five beams each, more than a prism has
/// sides less one; when the beam between them breaks, they touch all the same.
TEST(ContactOfBrokenBeams, TouchAlsoInsideABlockOfSeveralLayers) {
  Lattice lattice;
  const auto index = [](int i, int j, int k) { return i + 3 * j + 9 * k; };
  for (int k = 0; k < 2; ++k) {
    for (int j = 0; j < 3; ++j) {
      for (int i = 0; i < 3; ++i) {
        test::append_block(lattice, {1, 1, 1}, {1.0 * i, 1.0 * j, 1.0 * k});
        if (i < 2) lattice.beams.bodies.push_back({index(i, j, k), index(i + 1, j, k)});
        if (j < 2) lattice.beams.bodies.push_back({index(i, j, k), index(i, j + 1, k)});
        if (k < 1) lattice.beams.bodies.push_back({index(i, j, k), index(i, j, k + 1)});
      }
    }
  }
  const Part part = partition(lattice, PETSC_COMM_SELF);
  const auto contact = make_contact(part, lattice, {.young = young}, {});
  State<Spatial> state(18);
  const int below = index(1, 1, 0), above = index(1, 1, 1);
  const auto force = [&] {
    Wrenches<Spatial> w(18);
    contact->add(state, w);
    return w.of(static_cast<std::size_t>(above))[2];
  };
  EXPECT_EQ(force(), 0);
  const std::array<std::int32_t, 2> pair{below, above};
  contact->roles().broken_pairs->release({&pair, 1});
  EXPECT_NEAR(force(), 0, 1e-6);
  commit(*contact, state, 1e-3);
  state.record(static_cast<std::size_t>(above))[2] = -0.01;
  EXPECT_NEAR(force(), young * 0.01, 1e-3 * young * 0.01);
}

/// A sheet that drifts against a wall steps as without contact until it is near, then as its
/// contacts want it.
TEST(ContactStep, IsShorterOnceAnObstacleIsNear) {
  Lattice lattice = test::sheet(8, 6, 1);
  reorder(lattice);
  lattice.bodies.velocity.assign(lattice.bodies.position.size(), {0.3, 0, 0});
  Scene scene = contact_scene(false);
  scene.forces.beam = true;
  scene.beam.damping_ratio = 0.02;
  Scene plain = scene;
  plain.forces.contact = false;
  const auto with_wall = [&](double gap) {
    Scene walled = scene;
    walled.contact.young = 3e8;
    walled.obstacles = {half_space({4 + gap, 0, 0}, {-1, 0, 0})};
    walled.obstacles[0].name = "wall";
    return walled;
  };
  const auto stable_of = [&](const Scene& s) {
    test::Dynamics at_rest(s, lattice);
    return stable_step(at_rest.model(), at_rest.state()).dt;
  };
  const double alone = stable_of(plain), near = stable_of(with_wall(1e-3));
  EXPECT_DOUBLE_EQ(stable_of(with_wall(0.2)), alone);
  EXPECT_LT(near, 0.9 * alone);

  const Scene walled = with_wall(0.2);
  Model<Spatial> model(lattice, PETSC_COMM_SELF, {});
  add_forces(walled, {}, model);
  add_contact(walled, lattice, model);
  ExplicitOptions options;
  options.end = 0.8, options.history = 0.002;
  double most = 0, worst = 0, kinetic = 0;
  const RunResult result = run_explicit(model, options, [&](const Accepted<Spatial>& a) {
    for (const auto* list : {&a.columns, &a.forces}) {
      for (const auto& [name, value] : *list) {
        if (name == "contacts") most = std::max(most, value);
        if (name == "energy_kinetic") kinetic = std::max(kinetic, value);
        if (name == "energy_balance_error") worst = std::max(worst, std::abs(value));
      }
    }
  });
  EXPECT_TRUE(result.done) << result.message;
  EXPECT_GT(most, 2);
  EXPECT_NEAR(result.stable_dt / near, 1, 0.02);
  EXPECT_LT(result.dt, result.stable_dt);
  EXPECT_LT(worst, 1e-3 * kinetic);
}

}  // namespace
}  // namespace floe
