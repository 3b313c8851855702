// Works of the forces over steps of leapfrog: the quadrature by hand, and against the kinetic
// energy of free bodies.

#include "leapfrog/leapfrog_work.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "support/dynamics.h"
#include "support/lattices.h"
#include "support/random.h"

namespace floe {
namespace {

/// A force that tells given powers and adds no wrench.
class Told final : public Force<Spatial>, public DoesWork<Spatial> {
 public:
  explicit Told(LaterPowers kind) : kind_(kind) {}
  std::string_view name() const override { return "told"; }
  Roles<Spatial> roles() override { return {.work = this}; }
  void add(const State<Spatial>&, Wrenches<Spatial>&) override {}
  void report(const State<Spatial>&, std::span<const double>, Columns&) const override {}

  std::size_t works() const override { return 2; }
  void powers(std::span<double> out) const override { write(power, out); }
  LaterPowers later_powers() const override { return kind_; }
  void powers_with(const State<Spatial>&, std::span<double> out) const override {
    write(later, out);
  }
  void kept_powers(std::span<double> out) const override { write(kept, out); }

  double power = 0, later = 0, kept = 0;  ///< of the first; the second has twice as much [W]

 private:
  static void write(double p, std::span<double> out) { out[0] = p, out[1] = 2 * p; }
  LaterPowers kind_;
};

/// Three steps of 1, 2 and 4 s. The wrenches of evaluation n have the powers p_n with the
/// velocities before it and q_n with those after it.
constexpr std::array dts{1.0, 2.0, 4.0}, after{13.0, 17.0, 19.0};
constexpr std::array before{3.0, 5.0, 7.0, 11.0};

/// Works after each evaluation.
std::vector<double> works_of(LaterPowers kind) {
  auto owned = std::make_unique<Told>(kind);
  Told& told = *owned;
  std::vector<std::unique_ptr<Force<Spatial>>> forces;
  forces.push_back(std::move(owned));
  std::vector<double> works(2), all;
  LeapfrogWork<Spatial> steps(forces, works);
  const State<Spatial> state;
  for (std::size_t n = 0; n < before.size(); ++n) {
    told.power = before[n];
    told.kept = n > 0 ? after[n - 1] : 0;
    all.push_back(steps.works()[0]);
    EXPECT_EQ(steps.works()[1], 2 * all.back());
    if (n == after.size()) break;
    told.later = after[n];
    steps.take_powers();
    told.power = told.kept = 1e9;  // a commit may change what the force tells of the evaluation
    steps.take_step(state, dts[n]);
    EXPECT_EQ(steps.last_dt(), dts[n]);
  }
  return all;
}

TEST(LeapfrogWork, IsTheMeanForceTimesTheWay) {
  std::vector<double> expected{0};
  for (std::size_t n = 0; n < after.size(); ++n)
    expected.push_back(expected.back() + 0.5 * dts[n] * (after[n] + before[n + 1]));
  EXPECT_EQ(works_of(LaterPowers::at_once), expected);
  EXPECT_EQ(works_of(LaterPowers::in_next_evaluation), expected);
}

/// The first power has a quarter of its step, the last one three quarters of the step before it.
TEST(LeapfrogWork, SumsByPartsWhereLaterPowersAreUnknown) {
  const double first = 0.25 * dts[0] * before[0], second = dts[1] * before[1],
               third = dts[2] * before[2];
  const std::vector<double> expected{0, first + 0.75 * dts[0] * before[1],
                                     first + second + 0.75 * dts[1] * before[2],
                                     first + second + third + 0.75 * dts[2] * before[3]};
  EXPECT_EQ(works_of(LaterPowers::never), expected);
}

/// Bodies in water that lose speed only by drag: their kinetic energy falls by its work.
TEST(LeapfrogWork, OfDragIsTheLossOfKineticEnergy) {
  Lattice lattice = test::sheet(4, 3, 1.5, true);
  for (std::size_t b = 0; b < lattice.bodies.position.size(); ++b) {
    const Vec3<double> v = test::Random(b + 1).vector(2);
    lattice.bodies.velocity.push_back({v.x, v.y, 0});
  }
  Scene scene;
  scene.forces.drag = true;
  scene.drag = {.linear = 40, .coefficient = 2, .density = 1010, .current = {0.1, -0.2, 0}};
  test::Dynamics d(scene, lattice);
  d.set_step(0.01);
  const double start = d.kinetic();
  for (int n = 0; n < 5; ++n) {
    d.steps(20);
    EXPECT_NEAR(d.kinetic() - d.works()[0], start, 1e-12 * start);
    EXPECT_EQ(d.reported("energy_drag"), -d.works()[0]);
  }
  EXPECT_LT(d.kinetic(), 0.9 * start);
}

/// Bodies that a rising load moves have the energy that it gave.
TEST(LeapfrogWork, OfALoadIsTheKineticEnergy) {
  const Lattice lattice = test::sheet(4, 3, 1.5);
  Scene scene;
  Load load;
  load.name = "push", load.set = "left", load.force = {300, -200, 100}, load.ramp.seconds = 0.35;
  scene.loads = {load};
  test::Dynamics d(scene, lattice);
  d.set_step(0.01);
  for (int n = 0; n < 5; ++n) {
    d.steps(20);
    EXPECT_GT(d.kinetic(), 0);
    EXPECT_NEAR(d.reported("energy_external"), d.kinetic(), 1e-12 * d.kinetic());
  }
}

/// Velocities lag half of the last step behind an evaluation, and lead by half a step after it.
TEST(ExplicitStep, DatesVelocities) {
  const Lattice lattice = test::sheet(4, 3, 1.5);
  test::Dynamics d(test::beams_only(Shear::one_point), lattice);
  const State<Spatial>& state = d.state();
  EXPECT_EQ(state.velocity_time, 0);
  const double dt = 1e-5;
  d.set_step(dt);
  for (int n = 0; n < 3; ++n) {
    const double t = state.time;
    (void)d.step_without_evaluation();
    EXPECT_EQ(state.velocity_time, t + 0.5 * dt);
    d.evaluate();
    EXPECT_EQ(state.velocity_time, state.time - 0.5 * dt);
  }
}

/// The largest speed and spin are of bodies as they move: what forces would do to bodies that a
/// boundary holds does not count.
TEST(LeapfrogStepper, SpeedsOfHeldBodiesAreTheirs) {
  const Lattice lattice = test::sheet(6, 4, 1.2);
  Scene scene = test::beams_only(Shear::one_point);
  Boundary held;
  held.name = held.set = "left";
  held.fixed.fill(true);
  held.velocity = Point3{0.3, 0, 0};
  scene.boundaries = {held};
  Load pull;
  pull.name = "pull", pull.set = "left";
  pull.force = {0, 0, -1e8};
  scene.loads = {pull};
  test::Dynamics d(scene, lattice);
  d.set_step(1e-5);
  const State<Spatial>& state = d.state();
  for (int n = 0; n < 50; ++n) {
    const double speed2 = d.step_without_evaluation();
    double fastest = 0, spin = 0;
    for (std::size_t b = 0; b < lattice.bodies.position.size(); ++b) {
      fastest = std::max(fastest, length(velocity(state, b)));
      spin = std::max(spin, length(angular_velocity(state, b)));
    }
    EXPECT_GE(fastest, 0.3 - 1e-12);
    EXPECT_NEAR(state.fastest, fastest, 1e-14);
    EXPECT_NEAR(std::sqrt(speed2), fastest, 1e-14);
    EXPECT_NEAR(state.fastest_spin, spin, 1e-14);
    d.evaluate();
  }
}

}  // namespace
}  // namespace floe
