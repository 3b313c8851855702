// Implicit dynamics of lattices: order at large rotations, PETSc's alpha2 as a check, energy, large
// steps, failed steps, restarts, prescribed motions (model.md, "Implicit dynamics").
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <string>

#include "implicit/second_order_system.h"
#include "run/numbers.h"
#include "support/explicit_run.h"
#include "support/flying_bar.h"
#include "support/implicit_run.h"
#include "support/record.h"
#include "support/second_order.h"
#include "support/tension.h"

namespace floe::test {
namespace {

constexpr const char* section_name = "Implicit dynamics";
constexpr std::array radii{1.0, 0.8, 0.5, 0.0};

double difference(const State<Spatial>& a, const State<Spatial>& b) {
  return (configuration(a) - configuration(b)).lpNorm<Eigen::Infinity>();
}

Scene beams_only(double end, double damping = 0) {
  Scene scene;
  scene.forces.beam = true;
  scene.beam.shear = Shear::exact;
  scene.beam.damping_ratio = damping;
  scene.time.end = end;
  return scene;
}

// -- order ----------------------------------------------------------------------------------------

TEST(Implicit, IsOfOrderTwoAtLargeRotations) {
  const PetscOption tight("-snes_rtol", "1e-12");
  const Lattice lattice = flying_bar(2, 12);
  for (const double damping : {0.0, 0.05}) {
    const Scene scene = beams_only(0.5, damping);
    const auto at_end = [&](int steps) {
      const ImplicitRun run = run_implicitly(scene, lattice, scene.time.end / steps);
      EXPECT_TRUE(run.result.done) << run.result.message;
      EXPECT_EQ(run.result.steps, steps);
      return run.state;
    };
    const State<Spatial> fine = [&] {
      const PetscOption option = radius(1);
      return at_end(full_form() ? 8000 : 4000);
    }();
    const auto angle = [](const Quat<double>& a) {
      const Vec3<double> t = log_rotation(a);
      return std::sqrt(dot(t, t));
    };
    const double bent = angle(product(conjugate(rotation(fine, 0)), rotation(fine, 2)));
    const int levels = full_form() ? 3 : 2;
    for (const double rho : radii) {
      if ((rho == 0.8 || (damping > 0 && rho != 0.5)) && !full_form()) continue;
      const PetscOption option = radius(rho);
      const int coarse = rho == 0 ? 1000 : 500;
      std::vector<double> error;
      for (int k = 0; k < levels; ++k) error.push_back(difference(at_end(coarse << k), fine));
      for (std::size_t k = 0; k + 1 < error.size(); ++k)
        verify({.section = section_name,
                .quantity = text("flying bar: order from %d and %d steps, radius %g, damping %g",
                                 coarse << k, 2 * coarse << k, rho, damping),
                .value = std::log2(error[k] / error[k + 1]),
                .reference = 2.0,
                .tolerance = 0.15,
                .note = text("turned by %.2f rad, end against end %.2f rad, error %.1e",
                             angle(rotation(fine, 1)), bent, error[k])});
    }
    if (damping == 0) {
      EXPECT_LT(difference(run_scene(scene, lattice, scene.time.end / 32000).state, fine), 1e-4);
    }
  }
}

/// What alpha2 of PETSc makes of the same equations, without rotations in them.
TEST(Implicit, EqualsAlpha2AtRadiusOneOnALinearLattice) {
  const PetscOption rho = radius(1), theirs("-ts_alpha_radius", "1"), tight("-snes_rtol", "1e-14");
  Scene scene = beams_only(0.5, 0.2);
  scene.beam.kinematics = Kinematics::linear;
  Lattice lattice = flying_bar(6, 2);
  for (Point3& w : lattice.bodies.angular_velocity) w = 0.1 * w;
  const int steps = 100;
  const ImplicitRun ours = run_implicitly(scene, lattice, scene.time.end / steps);
  ASSERT_TRUE(ours.result.done) << ours.result.message;

  Model<Spatial> model(lattice, PETSC_COMM_SELF, {});
  add_forces(scene, {}, model);
  State<Spatial> state(lattice.bodies.position.size());
  const PetscOption lu("-pc_type", "lu");
  SecondOrderSystem<Spatial> equations(model, state);
  Handle<Vec> x = equations.make_vector(), v = equations.make_vector();
  equations.begin(x, v);
  Handle<TS> ts;
  check(TSCreate(PETSC_COMM_SELF, ts.put()));
  check(TSSetType(ts, TSALPHA2));
  check(TS2SetSolution(ts, x, v));
  check(TSSetI2Function(
      ts, nullptr,
      [](TS, PetscReal t, Vec at, Vec rate, Vec a, Vec f, void* self) noexcept {
        static_cast<SecondOrderSystem<Spatial>*>(self)->residual(t, at, rate, a, f);
        return PetscErrorCode{0};
      },
      &equations));
  check(TSSetI2Jacobian(
      ts, equations.matrix(), equations.matrix(),
      [](TS, PetscReal t, Vec at, Vec rate, Vec a, PetscReal by_v, PetscReal by_a, Mat, Mat,
         void* self) noexcept {
        static_cast<SecondOrderSystem<Spatial>*>(self)->assemble(t, at, rate, a, by_v, by_a);
        return PetscErrorCode{0};
      },
      &equations));
  check(TSSetTimeStep(ts, scene.time.end / steps));
  check(TSSetMaxSteps(ts, steps));
  check(TSSetMaxTime(ts, 1e30));
  check(TSSetExactFinalTime(ts, TS_EXACTFINALTIME_STEPOVER));
  check(TSSetFromOptions(ts));
  check(TSSolve(ts, nullptr));
  equations.take(scene.time.end, x, v);
  const double size = configuration(state).lpNorm<Eigen::Infinity>();
  verify({.section = section_name,
          .quantity = "linear bar: largest difference to PETSc's alpha2, radius 1, relative",
          .value = difference(ours.state, state) / size,
          .reference = 0.0,
          .tolerance = 1e-10,
          .note = "100 steps, dashpots"});
}

// -- energy ---------------------------------------------------------------------------------------

TEST(ImplicitEnergy, IsKeptAtRadiusOneAndLostAsTheRadiusSays) {
  Scene scene = beams_only(1, 0);
  scene.beam.kinematics = Kinematics::linear;
  scene.time.end = 20;
  const Lattice lattice = flying_bar(10, 2);
  double before = 1;
  for (const double rho : radii) {
    const PetscOption option = radius(rho);
    // The stiffest modes turn by 3 rad in a step.
    ImplicitRun run = run_implicitly(scene, lattice, 0.01);
    ASSERT_TRUE(run.result.done) << run.result.message;
    const double total = run.columns["energy_kinetic"] + run.columns["energy_strain"];
    const double first = total + run.columns["energy_numerical"];
    const double kept = total / first;
    if (rho == 1) {
      verify({.section = section_name,
              .quantity = "linear bar: energy that radius 1 loses in 2000 steps",
              .value = 1 - kept,
              .reference = 0.0,
              .tolerance = 1e-9});
    } else {
      report({.section = section_name,
              .quantity = text("linear bar: energy kept over 2000 steps, radius %g", rho),
              .value = kept,
              .note = "stiffest modes turn by about 3 rad per step"});
      EXPECT_LT(kept, before);
    }
    before = kept;
    // The balance knows what the method took.
    EXPECT_LT(std::abs(run.columns["energy_balance_error"]), 1e-10 * first) << rho;
  }
}

TEST(ImplicitEnergy, BalanceClosesWithTheStepAtLargeRotations) {
  Scene scene = beams_only(0.8, 0.05);
  const Lattice lattice = flying_bar(6, 12);
  for (const double rho : radii) {
    if (rho == 0.8 && !full_form()) continue;
    const PetscOption option = radius(rho);
    std::array<double, 2> error{}, lost{};
    double energy = 0;
    for (std::size_t k = 0; k < 2; ++k) {
      ImplicitRun run = run_implicitly(scene, lattice, scene.time.end / (k == 0 ? 800 : 3200));
      ASSERT_TRUE(run.result.done) << run.result.message;
      error[k] = std::abs(run.columns["energy_balance_error"]);
      lost[k] = run.columns["energy_numerical"];
      energy = run.columns["energy_kinetic"] + run.columns["energy_strain"];
      EXPECT_GT(run.columns["energy_damping"], 1e-3 * energy);
    }
    verify({.section = section_name,
            .quantity = text("flying bar: energy balance, 3200 steps, radius %g", rho),
            .value = error[1] / energy,
            .reference = 0.0,
            .tolerance = 1e-4,
            .note = text("800 steps %.1e; the method took %.1e and %.1e", error[0] / energy,
                         lost[0] / energy, lost[1] / energy)});
    EXPECT_GT(error[0] / error[1], 10) << rho;
  }
}

/// A pull by a boundary and a load, dashpots, ramps: all columns have something, and close.
TEST(ImplicitEnergy, WorkOfBoundariesAndLoadsIsThere) {
  Scene scene = tension_scene(10, 0.5, 1.5, 3);
  const Lattice lattice = mesh_of(scene);
  scene.boundaries[1].displacement.reset();
  scene.boundaries[1].velocity = Point3{0.1, 0, 0};
  scene.boundaries[1].ramp.seconds = 0.004;
  scene.beam.damping_ratio = 1;
  Load edge;
  edge.name = "edge", edge.set = "top", edge.force = {1e6, 0, 2e3}, edge.moment = {0, 1e3, 0};
  edge.ramp.seconds = 0.01;
  scene.loads = {edge};
  scene.time.end = 0.02;
  for (const double rho : radii) {
    const PetscOption option = radius(rho);
    for (const double dt : {0.001, 0.0001}) {
      ImplicitRun run = run_implicitly(scene, lattice, dt);
      ASSERT_TRUE(run.result.done) << run.result.message;
      const double moved =
          std::abs(run.columns["energy_boundary"]) + std::abs(run.columns["energy_external"]);
      EXPECT_GT(run.columns["energy_boundary"], 0.01 * moved);
      EXPECT_GT(run.columns["energy_external"], 0.01 * moved);
      EXPECT_GT(run.columns["energy_damping"], 0.01 * moved);
      EXPECT_LT(std::abs(run.columns["energy_balance_error"]), 1e-5 * moved) << rho << " " << dt;
    }
  }
}

// -- against others -------------------------------------------------------------------------------

/// The same motion as leapfrog's, reactions and energies included.
TEST(Implicit, MovesAsLeapfrogDoes) {
  Scene scene = tension_scene(10, 0.5, 1.5, 3);
  scene.forces.gravity = scene.forces.buoyancy = scene.forces.drag = true;
  scene.drag = {.linear = 4000, .coefficient = 100, .density = 1010, .current = {0.3, 0, 0}};
  scene.added_mass = 0.5;
  Lattice lattice = mesh_of(scene);
  scene.beam.damping_ratio = 0.3;
  scene.boundaries[0].fixed[4] = true;
  scene.boundaries[1].displacement.reset();
  scene.boundaries[1].velocity = Point3{0.1, 0, 0};
  scene.boundaries[1].fixed[3] = true;
  scene.boundaries[1].angular_velocity = {2, 0, 0};
  scene.boundaries[1].ramp.seconds = 0.004;
  for (std::size_t b = 0; b < lattice.bodies.position.size(); ++b) {
    lattice.bodies.velocity.push_back({0, 0.1, 0.2});
    lattice.bodies.angular_velocity.push_back({0.1, 0, 0.3});
  }
  scene.time.end = 0.02;
  const PetscOption option = radius(0.8);
  ExplicitRun leapfrog = run_scene(scene, lattice, 2e-6);
  ASSERT_TRUE(leapfrog.result.done) << leapfrog.result.message;
  ImplicitRun ours = run_implicitly(scene, lattice, 2e-5);
  ASSERT_TRUE(ours.result.done) << ours.result.message;
  const double size = configuration(leapfrog.state).lpNorm<Eigen::Infinity>();
  EXPECT_LT(difference(leapfrog.state, ours.state), 1e-4 * size);
  double energy = 0;
  for (const char* name : {"energy_boundary", "energy_damping", "energy_drag"})
    energy = std::max(energy, std::abs(leapfrog.columns[name]));
  for (const char* name :
       {"energy_kinetic", "energy_strain", "energy_boundary", "energy_damping", "energy_drag"})
    EXPECT_NEAR(ours.columns[name], leapfrog.columns[name], 5e-3 * energy) << name;
}

/// A floating sheet under a point load, at a thousand times the explicit limit.
TEST(Implicit, TakesAThousandTimesTheExplicitStep) {
  Scene scene;
  scene.has_sheet = true;
  scene.sheet = {20, 20, 1.5, 1, Relaxation::lloyd, 50, 0};
  scene.thickness = 0.5;
  scene.forces.beam = scene.forces.gravity = scene.forces.buoyancy = scene.forces.drag = true;
  scene.drag.linear = 4270;
  const Lattice lattice = mesh_of(scene);
  Load load;
  load.name = "p", load.point = Point2{2, 3}, load.force = {0, 0, -1e4}, load.ramp.seconds = 1;
  scene.loads = {load};
  const double stable = stable_of(scene, lattice);
  const double dt = std::ceil(1000 * stable / 0.1) * 0.1;
  scene.time.end = 20 * dt;
  scene.limit.energy_error = 1e-3;
  const ImplicitRun run = run_implicitly(scene, lattice, dt);
  ASSERT_TRUE(run.result.done) << run.result.message;
  EXPECT_EQ(run.result.steps, 20);
  EXPECT_GE(dt / stable, 1000);
  EXPECT_LE(run.result.newton_iterations, 80);
  Scene still = scene;
  still.forces.drag = false;
  still.time = {};
  const StaticSolution statics = solve_static(still, lattice);
  double error = 0, largest = 0;
  for (std::size_t b = 0; b < lattice.bodies.position.size(); ++b) {
    const double z = displacement(statics.last(), b).z;
    error = std::max(error, std::abs(displacement(run.state, b).z - z));
    largest = std::max(largest, std::abs(z));
  }
  verify({.section = section_name,
          .quantity = "floating sheet, step 1000 times the explicit limit: error at rest, relative",
          .value = error / largest,
          .reference = 0.0,
          .tolerance = 1e-3,
          .note = text("dt = %.2g s, %lld Newton iterations in 20 steps", dt,
                       static_cast<long long>(run.result.newton_iterations))});
}

/// The same without drag or dashpots, hit at once: nothing but the method damps.
TEST(Implicit, LargeStepsStayBoundedWhateverTheRadius) {
  Scene scene;
  scene.has_sheet = true;
  scene.sheet = {12, 12, 1.5, 1, Relaxation::lloyd, 50, 0};
  scene.thickness = 0.5;
  scene.forces.beam = scene.forces.gravity = scene.forces.buoyancy = true;
  const Lattice lattice = mesh_of(scene);
  Load load;
  load.name = "p", load.point = Point2{2, 3}, load.force = {0, 0, -3e3};
  scene.loads = {load};
  const double stable = stable_of(scene, lattice);
  scene.time.end = 200 * 1000 * stable;
  for (const double rho : radii) {
    const PetscOption option = radius(rho);
    ImplicitRun run = run_implicitly(scene, lattice, 1000 * stable);
    EXPECT_TRUE(run.result.done) << rho << ": " << run.result.message;
    EXPECT_EQ(run.result.steps, 200) << rho;
    const double z = configuration(run.state).lpNorm<Eigen::Infinity>();
    EXPECT_LT(run.columns["energy_strain"], run.columns["energy_external"]) << z;
  }
}

// -- failures and restarts ------------------------------------------------------------------------

/// Newton is given too few iterations for the given step, so steps are cut; what comes out is as
/// good as with steps that short.
TEST(Implicit, CutsStepsThatNewtonFails) {
  Scene scene = beams_only(0.4);
  scene.limit.energy_error = 10;
  const Lattice lattice = flying_bar(6, 25);
  const ImplicitRun fine = run_implicitly(scene, lattice, scene.time.end / 4000);
  const ImplicitRun whole = run_implicitly(scene, lattice, 0.02);
  ASSERT_TRUE(whole.result.done) << whole.result.message;
  EXPECT_EQ(whole.result.steps, 20);
  const PetscOption few("-snes_max_it", "4");
  const ImplicitRun cut = run_implicitly(scene, lattice, 0.02);
  ASSERT_TRUE(cut.result.done) << cut.result.message;
  EXPECT_GT(cut.result.steps, 20);
  EXPECT_NEAR(cut.state.time, scene.time.end, 1e-12);
  EXPECT_LT(difference(cut.state, fine.state), difference(whole.state, fine.state));
}

TEST(Implicit, GivesUpInOneLineWhenNoStepIsSmallEnough) {
  Scene scene = beams_only(0.4);
  const Lattice lattice = flying_bar(6, 25);
  const PetscOption cg("-ksp_type", "cg"), none("-pc_type", "none"), few("-ksp_max_it", "1");
  const ImplicitRun run = run_implicitly(scene, lattice, 0.02);
  EXPECT_FALSE(run.result.done);
  EXPECT_NE(run.result.message.find("no step from time "), std::string::npos) << run.result.message;
  EXPECT_NE(run.result.message.find("DIVERGED_LINEAR_SOLVE"), std::string::npos);
}

TEST(Implicit, GoesOnBitForBit) {
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("floe_implicit_" + std::to_string(getpid()));
  std::filesystem::create_directories(folder);
  const std::string file = folder / "checkpoint.h5";
  for (const double rho : {0.8, 0.0}) {
    for (const char* adapt : {"none", "basic"}) {
      const double dt = 0.004;
      const PetscOption option = radius(rho), adaptivity("-ts_adapt_type", adapt);
      Scene scene = beams_only(0.8, 0.05);
      scene.limit.energy_error = 10;
      const Lattice lattice = flying_bar(6, 25);
      const auto with_file = [&](DynamicOptions& o) {
        o.checkpoint.file = file;
        o.history = 0.2;  // steps end at 0.4, whatever the end
        o.checkpoint.at_end = true;
        o.checkpoint.stop_file = folder / "STOP";
      };
      const ImplicitRun straight = run_implicitly(scene, lattice, dt, with_file);
      ASSERT_TRUE(straight.result.done) << straight.result.message;
      scene.time.end = 0.4;
      ASSERT_TRUE(run_implicitly(scene, lattice, dt, with_file).result.done);
      scene.time.end = 0.8;
      const ImplicitRun rest = run_implicitly(scene, lattice, dt, [&](DynamicOptions& o) {
        with_file(o);
        o.checkpoint.restart = file;
      });
      ASSERT_TRUE(rest.result.done) << rest.result.message;
      EXPECT_EQ(rest.result.steps, straight.result.steps);
      EXPECT_EQ(rest.result.newton_iterations, straight.result.newton_iterations);
      EXPECT_EQ(std::memcmp(rest.state.records.data(), straight.state.records.data(),
                            rest.state.records.size() * sizeof(double)),
                0)
          << rho << " " << adapt << ": " << difference(rest.state, straight.state);
      EXPECT_EQ(rest.columns, straight.columns);
    }
  }
  std::filesystem::remove_all(folder);
}

// -- samples --------------------------------------------------------------------------------------

TEST(Implicit, StepsEndWhereSamplesAreAskedFor) {
  const Lattice lattice = flying_bar(6, 2);
  for (const double dt : {0.04, 0.0}) {
    const Scene scene = beams_only(0.5);
    const ImplicitRun run =
        run_implicitly(scene, lattice, dt, [](DynamicOptions& o) { o.history = 0.15; });
    ASSERT_TRUE(run.result.done) << run.result.message;
    const std::vector<double> expected{0, 0.15, 0.3, 0.45, 0.5};
    ASSERT_EQ(run.times.size(), expected.size()) << dt;
    for (std::size_t k = 0; k < expected.size(); ++k) EXPECT_NEAR(run.times[k], expected[k], 1e-12);
  }
}

}  // namespace
}  // namespace floe::test
