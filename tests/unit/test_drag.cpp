// Drag of the water: the law itself, its energy, the mass of water that bodies take along.

#include "water/drag.h"

#include <gtest/gtest.h>

#include <cmath>

#include "leapfrog/leapfrog_work.h"
#include "model/model.h"
#include "submersion/immersion.h"
#include "support/force_checks.h"
#include "support/lattices.h"
#include "support/roles.h"
#include "water/buoyancy.h"

namespace floe {
namespace {

/// A floating sheet, displaced, turned and moving.
struct Moving {
  Lattice lattice = test::sheet(6, 6, 1.5, true);
  Part part = partition(lattice, PETSC_COMM_SELF);
  State<Spatial> state = test::deformed(part, 0.2, 0.3);
  Moving() {
    for (std::size_t b = 0; b < static_cast<std::size_t>(part.local); ++b) {
      test::Random random(50 + b);
      const Vec3<double> v = random.vector(2);
      double* r = state.record(b) + Spatial::velocity;
      r[0] = v.x, r[1] = v.y, r[2] = v.z;
    }
  }
};

TEST(Drag, FollowsTheLaw) {
  const Moving m;
  const Immersion immersion(m.part);
  const DragOptions options{
      .linear = 300, .coefficient = 1.2, .density = 1025, .current = {0.3, -0.2, 0.1}};
  const auto drag = make_drag<Spatial>(m.part, options);
  const std::vector<double> w = test::wrenches_of(*drag, m.state);
  for (std::int32_t body = 0; body < m.part.owned; ++body) {
    const auto b = static_cast<std::size_t>(body);
    const double* r = m.state.record(b) + Spatial::velocity;
    const Vec3<double> v{r[0] - 0.3, r[1] + 0.2, r[2] - 0.1};
    const double area = m.lattice.bodies.mass[b] / (920 * 0.5);
    const double fraction = immersion.by_clipping(m.state, body).volume / immersion.volume(body);
    const double factor = -area * fraction * (300 + 0.5 * 1025 * 1.2 * std::sqrt(dot(v, v)));
    const std::array<double, 6> expected{factor * v.x, factor * v.y, factor * v.z, 0, 0, 0};
    for (std::size_t k = 0; k < 6; ++k) EXPECT_NEAR(w[6 * b + k], expected[k], 1e-9) << b;
  }
}

TEST(Drag, NothingActsInTheAirOrWithTheCurrent) {
  Moving m;
  const auto drag = make_drag<Spatial>(m.part, {.linear = 300, .coefficient = 1});
  for (std::int32_t b = 0; b < m.part.owned; ++b)
    m.state.record(static_cast<std::size_t>(b))[2] = 9;
  for (const double w : test::wrenches_of(*drag, m.state)) EXPECT_EQ(w, 0);
  for (std::int32_t b = 0; b < m.part.owned; ++b) {
    double* r = m.state.record(static_cast<std::size_t>(b));
    r[2] = -9;
    r[7] = 1, r[8] = 2, r[9] = 3;
  }
  const auto drifting =
      make_drag<Spatial>(m.part, {.linear = 300, .coefficient = 1, .current = {1, 2, 3}});
  for (const double w : test::wrenches_of(*drifting, m.state)) EXPECT_EQ(w, 0);
}

/// With a force that stays, the loss is the force times the way, whatever the velocities between.
TEST(Drag, LosesForceTimesWay) {
  Moving m;
  const auto drag = make_drag<Spatial>(m.part, {.linear = 300});
  std::vector<double> works(1);
  LeapfrogWork<Spatial> steps(std::span(&drag, 1), works);
  double expected = 0;
  for (const double dt : {0.1, 0.2}) {
    const std::vector<double> w = test::wrenches_of(*drag, m.state);
    const State<Spatial> before = m.state;
    for (std::int32_t b = 0; b < m.part.owned; ++b)
      for (std::size_t k = 7; k < 10; ++k) m.state.record(static_cast<std::size_t>(b))[k] *= 0.9;
    steps.take_powers();
    steps.take_step(m.state, dt);
    for (std::size_t b = 0; b < static_cast<std::size_t>(m.part.owned); ++b)
      for (std::size_t k = 0; k < 3; ++k)
        expected -=
            0.5 * w[6 * b + k] *
            (dt * m.state.record(b)[7 + k] + (dt == 0.2 ? 0.1 : 0.0) * before.record(b)[7 + k]);
  }
  const std::vector<double> w = test::wrenches_of(*drag, m.state);
  for (std::size_t b = 0; b < static_cast<std::size_t>(m.part.owned); ++b)
    for (std::size_t k = 0; k < 3; ++k)
      expected -= 0.5 * 0.2 * w[6 * b + k] * m.state.record(b)[7 + k];
  EXPECT_GT(expected, 0);
  const std::vector<double> now = steps.works();
  EXPECT_NEAR(test::potential_of(*drag, m.state, now), expected, 1e-12 * expected);
}

TEST(Drag, NeedsShapes) {
  Lattice bare = test::row(2);
  const Part part = partition(bare, PETSC_COMM_SELF);
  EXPECT_THROW((void)make_drag<Spatial>(part, {.linear = 1}), InputError);
  EXPECT_THROW((void)displaced_mass(part, 1000), InputError);
}

TEST(Drag, AddedMassResistsButDoesNotWeigh) {
  const Lattice lattice = test::sheet(6, 6, 1.5, true);
  Model<Spatial> model(lattice, PETSC_COMM_SELF, {});
  EXPECT_EQ(model.inertial_mass(), model.part().bodies.mass);
  model.add_mass(displaced_mass(model.part(), 0.5 * 1010));
  for (std::size_t b = 0; b < lattice.bodies.mass.size(); ++b) {
    EXPECT_NEAR(model.inertial_mass()[b] / model.part().bodies.mass[b], 1.5, 1e-12);
    EXPECT_EQ(model.part().bodies.mass[b],
              lattice.bodies.mass[static_cast<std::size_t>(model.part().global[b])]);
  }
}

}  // namespace
}  // namespace floe
