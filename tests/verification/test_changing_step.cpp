// The stable step falls in the course of a run: shorter steps from there on, or the end (model.md,
// "Explicit dynamics": Stable step).
#include <cmath>
#include <string>

#include "support/box.h"
#include "support/explicit_run.h"
#include "support/frames.h"
#include "support/record.h"
#include "support/static_solution.h"

namespace floe::test {
namespace {

constexpr const char* section_name = "Explicit dynamics";

/// A short bar, soft along itself and stiff across, is pressed to 0.4 of its length: its transverse
/// stiffness k_s (l0/l)^2 grows to six times as much and the stable step falls to 0.4.
struct Pressed {
  Scene scene = beams_only(Shear::one_point);
  Lattice lattice;
  double first;  ///< stable step at rest [s]
  Pressed() {
    FrameSection section;
    section.young = 100, section.shear_modulus = 1e5;
    lattice = straight_frame(1, 1, section);
    for (std::size_t b = 0; b < 2; ++b) {
      lattice.bodies.mass[b] = 10;
      lattice.bodies.inertia[b] = {1e3, 1e3, 1e3};
      lattice.bodies.velocity.push_back({0, b == 0 ? 1e-6 : 0.0, 0});
      lattice.bodies.angular_velocity.push_back({0, 0, 0});
    }
    first = stable_of(scene, lattice);
    scene.time.end = 40000 * first;
    Boundary root, tip;
    root.name = root.set = "root";
    root.fixed = {true, false, true, true, true, true};
    tip.name = tip.set = "tip";
    tip.fixed = {true, true, true, true, true, true};
    tip.displacement = Point3{-0.6, 0, 0};
    tip.ramp.seconds = scene.time.end;
    scene.boundaries = {root, tip};
    first = stable_of(scene, lattice);
  }
  /// That at rest of a bar whose shear stiffness is (l0/l)^2 as much.
  double last() const {
    Lattice shorter = lattice;
    shorter.beams.shear_modulus[0] /= 0.4 * 0.4;
    return stable_of(scene, shorter);
  }
};

TEST(ChangingStep, ShortensAsABarStiffens) {
  const Pressed c;
  for (const char* type : {"leapfrog", "rk"}) {
    const PetscOption kind("-ts_type", type), method("-ts_rk_type", "4");
    ExplicitRun run = run_scene(c.scene, c.lattice, 0, 200);
    EXPECT_TRUE(run.result.done) << type << ": " << run.result.message;
    EXPECT_DOUBLE_EQ(run.state.time, c.scene.time.end) << type;
    EXPECT_LT(run.result.dt, run.result.stable_dt) << type;
    // What vibrates across stays as small as it was; its energy grows with its frequency.
    const double* r = run.state.record(0);
    EXPECT_LT(std::abs(r[1]), 1e-6 / 20 * c.scene.time.end) << type;
    EXPECT_LT(std::abs(r[Spatial::velocity + 1]), 5e-6) << type;
    EXPECT_LT(std::abs(run.columns["energy_balance_error"]), 1e-4 * run.columns["energy_boundary"])
        << type;
    if (std::string(type) == "rk") continue;
    verify({.section = section_name,
            .quantity = "a bar pressed to 0.4 of its length: stable_dt over that of a bar with its "
                        "last stiffness",
            .value = run.result.stable_dt / c.last(),
            .reference = 1.0,
            .tolerance = 0.06,
            .note = text("found anew as it stiffens; at first %.2f", c.first / c.last())});
  }
}

TEST(ChangingStep, EndsARunWhoseStepIsGiven) {
  const Pressed c;
  const ExplicitRun run = run_scene(c.scene, c.lattice, 0.9 * c.first, 200);
  EXPECT_FALSE(run.result.done);
  EXPECT_NE(run.result.message.find("the stable step has fallen to"), std::string::npos)
      << run.result.message;
  EXPECT_NE(run.result.message.find("limited by the shifting of body"), std::string::npos)
      << run.result.message;
  // Where 0.9 of the first step is the stable one: (l/l0)^2 = 0.9^2 about.
  const double shortened = 0.6 * run.state.time / c.scene.time.end;
  EXPECT_LT(shortened, 0.25);
}

TEST(ChangingStep, WithoutItTheRunBlowsUp) {
  Pressed c;
  c.scene.time.allow_unstable = true;
  const ExplicitRun run = run_scene(c.scene, c.lattice, 0.9 * c.first);
  EXPECT_FALSE(run.result.done);
  EXPECT_NE(run.result.message.find("limit: "), std::string::npos) << run.result.message;
}

TEST(ChangingStep, IsFoundAsABlockComesToTheWater) {
  Scene scene;
  scene.integrator = Integrator::explicit_;
  scene.forces.gravity = scene.forces.buoyancy = true;
  scene.time.end = 30;
  scene.limit.energy_error = 1e3;
  // In the air nothing limits the step; afloat 2/omega does: omega^2 = rho_w g/(rho h).
  const Lattice falling = box({2, 2, 0.5}, 920, 0.3, {0, 0, 0});
  const double afloat = 2 / std::sqrt(1010 * 9.81 / (920 * 0.5));
  const ExplicitRun good = run_scene(scene, falling, 0.9 * afloat, 200);
  EXPECT_TRUE(good.result.done) << good.result.message;
  EXPECT_LE(good.result.stable_dt, afloat * 1.01);
  const ExplicitRun bad = run_scene(scene, falling, 1.2 * afloat, 200);
  EXPECT_FALSE(bad.result.done);
  EXPECT_NE(bad.result.message.find("the stable step has fallen to"), std::string::npos)
      << bad.result.message;
}

TEST(ChangingStep, IsFoundAsQuadraticDragGrowsWithTheSpeed) {
  // Pushed under water: m v' = F - k v^2, k = rho_w C_d A/2, to the speed sqrt(F/k); there small
  // changes decay at 2 k v/m, and leapfrog takes steps up to 2/(that).
  Scene scene;
  scene.integrator = Integrator::explicit_;
  scene.forces.drag = true;
  scene.drag.coefficient = 1.2;
  Lattice block = box({2, 2, 0.5}, 920, -5, {1, 0, 0});
  block.sets["all"] = {0};
  const double k = 0.5 * 1010 * 1.2 * 4, mass = 920 * 2, speed = 30, rate = 2 * k * speed / mass;
  Load push;
  push.name = "push", push.set = "all", push.force = {k * speed * speed, 0, 0};
  push.ramp.seconds = 400;
  scene.loads = {push};
  scene.time.end = 420;
  ExplicitRun run = run_scene(scene, block, 0, 200);
  EXPECT_TRUE(run.result.done) << run.result.message;
  verify({.section = section_name,
          .quantity = "quadratic drag: stable_dt over that at the largest speed, m/(k v)",
          .value = run.result.stable_dt * rate / 2,
          .reference = 1.0,
          .tolerance = 0.05,
          .note = "found anew as it speeds up"});
  EXPECT_LT(run.result.dt, 2 / rate);
  EXPECT_NEAR(run.state.record(0)[Spatial::velocity], speed, 1e-3 * speed);
}

}  // namespace
}  // namespace floe::test
