// PETSc's Runge-Kutta methods on bodies: orders at large rotations, prescribed motions, the ledger,
// momenta, adaptive steps (model.md, "Explicit dynamics": Runge-Kutta).
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "support/explicit_run.h"
#include "support/flying_bar.h"
#include "support/record.h"
#include "support/static_solution.h"

namespace floe::test {
namespace {

constexpr const char* section_name = "Runge-Kutta";

ExplicitRun run_rk(const char* type, Scene scene, const Lattice& lattice, double dt) {
  const PetscOption rk("-ts_type", "rk"), kind("-ts_rk_type", type);
  scene.time.allow_unstable = true;
  ExplicitRun run = run_scene(scene, lattice, dt, 10);
  EXPECT_TRUE(run.result.done) << type << ": " << run.result.message;
  return run;
}

/// Largest difference of displacements and rotations, and of velocities over `rate`.
double apart(const State<Spatial>& a, const State<Spatial>& b, double rate = 0) {
  double most = 0;
  for (std::size_t k = 0; k < a.records.size(); ++k) {
    const std::size_t at = k % Spatial::record;
    const double difference = std::abs(a.records[k] - b.records[k]);
    if (at < static_cast<std::size_t>(Spatial::velocity)) most = std::max(most, difference);
    if (rate > 0 && at >= static_cast<std::size_t>(Spatial::velocity) &&
        at < static_cast<std::size_t>(Spatial::angular_momentum))
      most = std::max(most, difference / rate);
  }
  return most;
}

/// The flying bar, softer: its fastest vibrations do not hide the order.
Lattice soft_bar() {
  Lattice bar = flying_bar(3, 4);
  for (double& young : bar.beams.young) young *= 0.02;
  for (double& shear : bar.beams.shear_modulus) shear *= 0.02;
  return bar;
}

/// That bar, damped, its first body carried along: x, z and two of its three rotations are
/// prescribed, with accelerations; a force and a moment pull at its end.
struct Carried {
  Scene scene = beams_only(Shear::exact, 0.05);
  Lattice lattice = soft_bar();
  Carried() {
    lattice.bodies.inertia[0] = {0.5, 0.9, 1.3};
    lattice.bodies.orientation[0] = {0.8, 0.36, 0.48, 0};
    scene.time.end = 0.6;
    Boundary root;
    root.name = root.set = "root";
    root.fixed = {true, false, true, false, true, true};
    root.velocity = Point3{2, 0, -1};
    root.angular_velocity = {0, -1.5, 3};
    root.ramp.seconds = 1;
    scene.boundaries = {root};
    Load tip;
    tip.name = "tip", tip.set = "tip", tip.force = {30, 20, -50}, tip.moment = {5, -8, 10};
    tip.ramp.seconds = 1;
    scene.loads = {tip};
  }
};

struct Method {
  const char* type;
  int order, steps;  // steps: of the coarsest run
};
// So many steps that the coarsest error is small and the finest well above rounding.
constexpr Method methods[] = {{"2a", 2, 800}, {"2b", 2, 800}, {"3", 3, 400},   {"3bs", 3, 400},
                              {"4", 4, 200},  {"5f", 5, 120}, {"5dp", 5, 120}, {"5bs", 5, 160},
                              {"6vr", 6, 80}, {"7vr", 7, 50}, {"8vr", 8, 40}};

TEST(RungeKutta, EveryMethodHasItsOrderAtLargeRotations) {
  Scene scene = beams_only(Shear::exact);
  scene.time.end = 1;
  const Lattice lattice = soft_bar();
  const State<Spatial> exact = run_rk("8vr", scene, lattice, 1.0 / 3200).state;
  for (const Method& m : methods) {
    std::array<double, 2> errors{};
    for (std::size_t k = 0; k < 2; ++k)
      errors[k] = apart(run_rk(m.type, scene, lattice, 1.0 / (m.steps << k)).state, exact);
    verify({.section = section_name,
            .quantity = text("%s: order from %d and %d steps", m.type, m.steps, 2 * m.steps),
            .value = std::log2(errors[0] / errors[1]),
            .reference = m.order,
            .tolerance = 0.4,
            .note = text("flying bar, 3 beams; errors %.1e and %.1e", errors[0], errors[1])});
  }
}

TEST(RungeKutta, KeepsItsOrderAndItsLedgerWithLossesAndPrescribedMotion) {
  const Carried c;
  const double end = c.scene.time.end;
  const ExplicitRun exact = run_rk("8vr", c.scene, c.lattice, end / 3200);
  for (const Method& m : methods) {
    std::array<double, 2> errors{}, balance{};
    double moved = 0;
    for (std::size_t k = 0; k < 2; ++k) {
      ExplicitRun run = run_rk(m.type, c.scene, c.lattice, end / (m.steps << k));
      errors[k] = apart(run.state, exact.state, 10);
      balance[k] = run.largest_balance_error;
      moved = std::abs(run.columns["energy_boundary"]) + std::abs(run.columns["energy_external"]) +
              std::abs(run.columns["energy_damping"]);
    }
    const std::string note = text(
        "bar carried by x, z, ry, rz of its end; %d and %d steps; "
        "balance over the work %.1e and %.1e",
        m.steps, 2 * m.steps, balance[0] / moved, balance[1] / moved);
    verify({.section = section_name,
            .quantity = text("%s, prescribed motion and losses: order", m.type),
            .value = std::log2(errors[0] / errors[1]),
            .reference = m.order,
            .tolerance = 0.4,
            .note = note});
    // An energy can converge faster than the state does.
    verify({.section = section_name,
            .quantity =
                text("%s, prescribed motion and losses: the balance converges as fast", m.type),
            .value = std::min(std::log2(balance[0] / balance[1]), m.order + 0.0),
            .reference = m.order,
            .tolerance = 0.4,
            .note = note});
  }
}

TEST(RungeKutta, FollowsPrescribedMotionsAsLeapfrogDoes) {
  const Carried c;
  const double end = c.scene.time.end;
  ExplicitRun rk = run_rk("4", c.scene, c.lattice, end / 1200);
  // With dashpots leapfrog's error is of first order: extrapolated from two runs.
  const ExplicitRun coarse = run_scene(c.scene, c.lattice, end / 10000);
  ExplicitRun leapfrog = run_scene(c.scene, c.lattice, end / 20000);
  ASSERT_TRUE(leapfrog.result.done) << leapfrog.result.message;
  const double error = apart(coarse.state, leapfrog.state);
  for (std::size_t k = 0; k < leapfrog.state.records.size(); ++k)
    leapfrog.state.records[k] = 2 * leapfrog.state.records[k] - coarse.state.records[k];
  verify({.section = section_name,
          .quantity = "4 and leapfrog, prescribed motion and losses: places and rotations apart",
          .value = apart(rk.state, leapfrog.state),
          .reference = 0.0,
          .tolerance = 1e-6,
          .unit = "m, 1",
          .note = text("leapfrog extrapolated from runs that are %.1e apart", error)});
  for (const char* name : {"energy_boundary", "energy_external", "energy_damping", "energy_kinetic",
                           "energy_strain"}) {
    EXPECT_NEAR(rk.columns.at(name), 2 * leapfrog.columns.at(name) - coarse.columns.at(name),
                1e-5 * std::abs(leapfrog.columns.at("energy_boundary")))
        << name;
  }
  // x, z, and the angular velocity are what the boundary says.
  const double* root = rk.state.record(0);
  const double integral = 0.5 * end * end, ramp = end;
  EXPECT_DOUBLE_EQ(root[0], 2 * integral);
  EXPECT_DOUBLE_EQ(root[2], -integral);
  EXPECT_DOUBLE_EQ(root[Spatial::velocity], 2 * ramp);
  EXPECT_DOUBLE_EQ(root[Spatial::angular_velocity + 1], -1.5 * ramp);
  EXPECT_DOUBLE_EQ(root[Spatial::angular_velocity + 2], 3 * ramp);
}

TEST(RungeKutta, KeepsMomentaInFreeFlight) {
  Scene scene = beams_only(Shear::exact);
  scene.time.end = 1;
  const Lattice lattice = flying_bar(3, 10);
  const auto momenta = [&](const State<Spatial>& s) {
    std::array<double, 6> sum{};
    for (std::size_t b = 0; b < lattice.bodies.mass.size(); ++b) {
      const double* r = s.record(b);
      const double* v = r + Spatial::velocity;
      const double* l = r + Spatial::angular_momentum;
      const double m = lattice.bodies.mass[b];
      const Vec3<double> p{m * v[0], m * v[1], m * v[2]};
      const Vec3<double> turn = cross(lattice.bodies.position[b] + displacement(s, b), p);
      const std::array<double, 6> mine{p.x, p.y, p.z, l[0] + turn.x, l[1] + turn.y, l[2] + turn.z};
      for (std::size_t k = 0; k < 6; ++k) sum[k] += mine[k];
    }
    return sum;
  };
  const ExplicitRun begun = run_rk("4", scene, lattice, 1.0 / 800);
  scene.time.end = 1e-9;  // as good as the beginning
  const std::array<double, 6> before = momenta(run_rk("4", scene, lattice, 1e-9).state),
                              after = momenta(begun.state);
  double linear = 0, angular = 0, size = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    linear = std::max(linear, std::abs(after[k] - before[k]));
    angular = std::max(angular, std::abs(after[3 + k] - before[3 + k]));
    size = std::max(size, std::abs(before[k]));
  }
  verify({.section = section_name,
          .quantity = "4: change of the linear momentum in free flight, relative",
          .value = linear / size,
          .reference = 0.0,
          .tolerance = 1e-13});
  verify({.section = section_name,
          .quantity = "4: change of the angular momentum in free flight",
          .value = angular,
          .reference = 0.0,
          .tolerance = 1e-5,
          .unit = "kg m^2/s",
          .note = "of the method's order: x cross p is quadratic"});
}

TEST(RungeKutta, AdaptiveStepsKeepTheirTolerance) {
  const Carried c;
  const double end = c.scene.time.end;
  const State<Spatial> exact = run_rk("8vr", c.scene, c.lattice, end / 3200).state;
  const PetscOption adapt("-ts_adapt_type", "basic"), relative("-ts_rtol", "0");
  std::array<double, 2> errors{};
  std::array<std::int64_t, 2> steps{};
  for (std::size_t k = 0; k < 2; ++k) {
    const PetscOption absolute("-ts_atol", k == 0 ? "1e-6" : "1e-9");
    const ExplicitRun run = run_rk("5dp", c.scene, c.lattice, end / 50);
    errors[k] = apart(run.state, exact);
    steps[k] = run.result.steps;
    EXPECT_DOUBLE_EQ(run.state.time, end);
    EXPECT_LT(std::abs(run.columns.at("energy_balance_error")),
              1e-3 * std::abs(run.columns.at("energy_boundary")));
  }
  const std::string note = text("5dp, %lld and %lld steps", static_cast<long long>(steps[0]),
                                static_cast<long long>(steps[1]));
  verify({.section = section_name,
          .quantity = "adaptive, -ts_atol 1e-9: error of places and rotations",
          .value = errors[1],
          .reference = 0.0,
          .tolerance = 1e-6,
          .unit = "m, 1",
          .note = note});
  EXPECT_LT(errors[1], 1e-2 * errors[0]);
  EXPECT_GT(steps[1], 2 * steps[0]);
}

}  // namespace
}  // namespace floe::test
