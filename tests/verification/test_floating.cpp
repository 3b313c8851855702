// A floating block: heave, roll, draft, drag and drift, against formulas (model.md, "Water").

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "scene_model/scene_model.h"
#include "support/box.h"
#include "support/dynamics.h"
#include "support/record.h"

namespace floe::test {
namespace {

constexpr const char* section_name = "Water";
constexpr double side = 4, thickness = 1, ice = 920, water = 1010, gravity = 9.81;
constexpr double area = side * side, mass = ice * area * thickness;
constexpr double floating = thickness * (0.5 - ice / water);  // height of the centroid [m]

/// The block, its centroid at the given height.
Lattice block(double height, const Point3& velocity, const Point3& spin = {}) {
  return box({side, side, thickness}, ice, height, velocity, spin);
}

Scene afloat() {
  Scene scene;
  scene.integrator = Integrator::explicit_;
  scene.forces.gravity = scene.forces.buoyancy = true;
  return scene;
}

/// Samples of a run, and what the ledger says at each.
struct Course {
  std::vector<double> time;
  std::vector<std::array<double, Spatial::record>> first_body;
  std::vector<double> balance_error, drag, kinetic;
  RunResult result;

  double worst_error() const {
    double worst = 0;
    for (const double e : balance_error) worst = std::max(worst, std::abs(e));
    return worst;
  }
  /// Velocities stand half a step before the sample.
  double velocity(std::size_t component) const {
    return first_body.back()[static_cast<std::size_t>(Spatial::velocity) + component];
  }
  double time_of_velocity() const { return time.back() - 0.5 * result.dt; }
};

Course run(const Scene& scene, const Lattice& lattice, double end, double dt, double every) {
  Model<Spatial> model(lattice, PETSC_COMM_SELF, {});
  add_forces(scene, {}, model);
  ExplicitOptions options;
  options.end = end;
  options.dt = dt;
  options.history = every;
  Course r;
  r.result = run_explicit(model, options, [&](const Accepted<Spatial>& a) {
    r.time.push_back(a.state.time);
    std::array<double, Spatial::record> record{};
    std::copy_n(a.state.record(0), Spatial::record, record.begin());
    r.first_body.push_back(record);
    for (const auto& [name, value] : a.columns) {
      if (name == "energy_balance_error") r.balance_error.push_back(value);
      if (name == "energy_kinetic") r.kinetic.push_back(value);
    }
    for (const auto& [name, value] : a.forces)
      if (name == "energy_drag") r.drag.push_back(value);
  });
  EXPECT_TRUE(r.result.done) << r.result.message;
  return r;
}

/// Angular frequency of an oscillation about 0, from its first to its last passage through 0.
double frequency(const std::vector<double>& time, const std::vector<double>& value) {
  std::vector<double> passages;
  for (std::size_t k = 1; k + 1 < time.size(); ++k) {
    if ((value[k] < 0) == (value[k + 1] < 0)) continue;
    passages.push_back(time[k] + (time[k + 1] - time[k]) * value[k] / (value[k] - value[k + 1]));
  }
  EXPECT_GT(passages.size(), 10U);
  return std::numbers::pi * static_cast<double>(passages.size() - 1) /
         (passages.back() - passages.front());
}
std::vector<double> history(const Course& r, std::size_t component) {
  std::vector<double> values;
  for (const auto& record : r.first_body) values.push_back(record[component]);
  return values;
}

void verify_ratio(const std::string& quantity, double value, double reference, double tolerance,
                  const std::string& note = {}) {
  verify({.section = section_name,
          .quantity = quantity,
          .value = value / reference,
          .reference = 1.0,
          .tolerance = tolerance,
          .note = note});
}

TEST(Floating, HeavesAtItsFrequency) {
  for (const double added : {0.0, 0.5}) {
    Scene scene = afloat();
    scene.added_mass = added;
    const Course r = run(scene, block(floating, {0, 0, 0.03}), 40, 2e-3, 2e-3);
    // What a body displaces at its draft is its own mass.
    const double omega = std::sqrt(water * gravity * area / (mass * (1 + added)));
    verify_ratio("heave frequency of a block" + std::string(added > 0 ? ", added mass 0.5" : ""),
                 frequency(r.time, history(r, 2)), omega, 1e-3, "over sqrt(rho_w g A/m)");
    const double moved = 0.5 * mass * (1 + added) * 0.03 * 0.03;
    EXPECT_NEAR(r.kinetic.front() / moved, 1, 1e-12);
    EXPECT_LT(r.worst_error(), 1e-4 * moved);
  }
}

TEST(Floating, RollsAtItsFrequency) {
  const Course r = run(afloat(), block(floating, {}, {0.01, 0, 0}), 40, 2e-3, 2e-3);
  const double draft = thickness * ice / water, volume = area * draft;
  const double stiffness =
      water * gravity * (side * side * side * side / 12 + volume * (-draft / 2 - floating));
  const double omega = std::sqrt(stiffness / (mass * (side * side + thickness * thickness) / 12));
  verify_ratio("roll frequency of a block", frequency(r.time, history(r, 4)), omega, 1e-3,
               "over sqrt(rho_w g (I + V(z_B - z_G))/I_x)");
}

TEST(Floating, ComesToRestAtItsDraft) {
  for (const double from : {0.3, -0.3, 1.5}) {  // sides cut; awash; dropped from the air
    Scene scene = afloat();
    scene.forces.drag = true;
    scene.drag.linear = 5000;
    const Course r = run(scene, block(floating + from, {}), 30, 2e-3, 0.1);
    const double bottom = floating + from + r.first_body.back()[2] - thickness / 2;
    verify_ratio("draft of a block released " + std::to_string(from).substr(0, 4) + " m off",
                 -bottom, thickness * ice / water, 1e-9, "over h rho_i/rho_w, linear drag");
    verify({.section = section_name,
            .quantity = "energy balance of that block: largest error over the energy lost",
            .value = r.worst_error() / r.drag.back(),
            .reference = 0.0,
            .tolerance = from == 0.3 ? 1e-12 : 1e-4,
            .note = from == 0.3 ? "its sides cut all the time" : "cut at edges for a while"});
  }
}

TEST(Floating, RestsWhereItFloats) {
  const Course r = run(afloat(), block(floating, {}), 10, 2e-3, 0.1);
  EXPECT_LT(std::abs(r.first_body.back()[2]), 1e-12);
}

TEST(Drag, DecayOfVelocity) {
  Scene scene = afloat();
  scene.forces = {};
  scene.forces.drag = true;
  const Point3 start{0.8, -0.6, 0};
  const auto speed = [](const Course& r) { return std::hypot(r.velocity(0), r.velocity(1)); };

  scene.drag.linear = 500;
  const Course linear = run(scene, block(-2, start), 4, 2e-4, 0.1);
  const double rate = 500 * area / mass;
  verify_ratio("velocity under linear drag after 4 s", speed(linear),
               std::exp(-rate * linear.time_of_velocity()), 1e-3, "over exp(-c A t/m)");
  // Half submerged: half of it.
  const Course half = run(scene, block(0, start), 4, 2e-4, 0.1);
  verify_ratio("the same, half submerged", speed(half),
               std::exp(-0.5 * rate * half.time_of_velocity()), 1e-3);

  scene.drag.linear = 0;
  scene.drag.coefficient = 1.2;
  const Course quadratic = run(scene, block(-2, start), 4, 2e-4, 0.1);
  const double k = 0.5 * water * 1.2 * area / mass;
  verify_ratio("velocity under quadratic drag after 4 s", speed(quadratic),
               1 / (1 + k * quadratic.time_of_velocity()), 1e-3,
               "over 1/(1 + rho_w C_d A v0 t/2m)");

  scene.drag.linear = 500;
  scene.drag.coefficient = 0;
  scene.added_mass = 1;
  const Course heavier = run(scene, block(-2, start), 4, 2e-4, 0.1);
  verify_ratio("velocity under linear drag with added mass 1", speed(heavier),
               std::exp(-rate / (1 + water / ice) * heavier.time_of_velocity()), 1e-3,
               "over exp(-c A t/(m + rho_w V))");
  for (const Course* r : {&linear, &half, &quadratic, &heavier})
    EXPECT_LT(r->worst_error(), 1e-6 * r->drag.back());
}

/// What tests step by hand (support/dynamics.h) takes the water along as well.
TEST(AddedMass, SlowsAFallStepByStep) {
  Scene scene;
  scene.forces.gravity = true;
  scene.added_mass = 1;
  Dynamics falling(scene, block(-2, {0, 0, 0}));
  const double dt = 1e-3;
  falling.set_step(dt);
  falling.steps(100);
  EXPECT_NEAR(falling.state().record(0)[Spatial::velocity + 2] / (-gravity * 99.5 * dt),
              ice / (ice + water), 1e-12);
}

TEST(Drag, BlockDriftsWithTheCurrent) {
  Scene scene = afloat();
  scene.forces.drag = true;
  scene.drag = {.linear = 2000, .coefficient = 1, .density = water, .current = {0.5, -0.2, 0}};
  const Course r = run(scene, block(floating, {}), 20, 2e-3, 0.1);
  verify({.section = section_name,
          .quantity = "terminal drift velocity against the current",
          .value = std::hypot(r.velocity(0) - 0.5, r.velocity(1) + 0.2, r.velocity(2)),
          .reference = 0.0,
          .tolerance = 1e-9,
          .unit = "m/s"});
  // All of the block's energy is the water's work.
  const double gained = 0.5 * mass * (0.5 * 0.5 + 0.2 * 0.2);
  verify_ratio("energy that the current gave to the block", -r.drag.back(), gained, 1e-5,
               "over m v^2/2");
  EXPECT_LT(r.worst_error(), 1e-5 * gained);
}

/// What the ledger misses falls with the square of the step, and does not grow with time.
TEST(Drag, EnergyBalanceClosesWithTheStep) {
  Scene scene = afloat();
  scene.forces.drag = true;
  scene.drag = {.linear = 2000, .coefficient = 2, .density = water, .current = {0.5, 0, 0}};
  std::array<double, 3> error{};
  for (std::size_t k = 0; k < error.size(); ++k) {
    const Course r = run(scene, block(floating + 0.05, {-1, 0.5, 0}, {0.01, 0, 0.3}), 5,
                         8e-3 / std::pow(2, k), 0.1);
    error[k] = r.worst_error() / mass;
  }
  verify({.section = section_name,
          .quantity = "order of the balance error with drag and current",
          .value = std::log2(error[1] / error[2]),
          .reference = 2.0,
          .tolerance = 0.1});
}

TEST(Drag, SheetInACurrentKeepsItsLedger) {
  Scene scene = afloat();
  scene.forces.beam = scene.forces.drag = true;
  scene.drag = {.linear = 1000, .coefficient = 1, .density = water, .current = {0.5, 0, 0}};
  scene.beam.shear = Shear::one_point;
  Lattice lattice = sheet(6, 6, 1.5, true);
  lattice.bodies.velocity.assign(lattice.bodies.position.size(), Point3{});
  for (std::size_t b = 0; b < lattice.bodies.position.size(); ++b)
    lattice.bodies.velocity[b] = {0, 0, 0.02 * lattice.bodies.position[b][0]};
  const Course r = run(scene, lattice, 2, 0, 0.02);
  verify({.section = section_name,
          .quantity = "energy balance of a sheet in a current: largest error over its energy",
          .value = r.worst_error() / r.kinetic.back(),
          .reference = 0.0,
          .tolerance = 1e-9,
          .note = "dt auto"});
}

}  // namespace
}  // namespace floe::test
