// Forces of a planar model against those of a spatial one on states in the plane.
#include <gtest/gtest.h>

#include "floe/base/petsc.h"
#include "forces/dead_load.h"
#include "leapfrog/leapfrog_work.h"
#include "model/model.h"
#include "support/force_checks.h"
#include "support/lattices.h"
#include "support/planar.h"
#include "support/roles.h"
#include "water/drag.h"

namespace floe {
namespace {

using test::deformed_in_plane;

/// Largest difference of wrenches over their norm; what points out of plane must be 0.
double difference(const Wrenches<Planar>& planar, const Wrenches<Spatial>& spatial,
                  std::size_t bodies) {
  double largest = 0, norm2 = 0;
  for (std::size_t b = 0; b < bodies; ++b) {
    const auto a = components_of(planar, b), e = components_of(spatial, b);
    for (std::size_t k = 0; k < 6; ++k) {
      largest = std::max(largest, std::abs(a[k] - e[k]));
      norm2 += e[k] * e[k];
    }
  }
  return largest / std::sqrt(norm2);
}

/// Columns that two forces report are the same.
void expect_same_report(Force<Planar>& planar, const State<Planar>& p, Force<Spatial>& spatial,
                        const State<Spatial>& s, double tolerance = 1e-12,
                        const std::vector<double>& planar_works = {},
                        const std::vector<double>& spatial_works = {}) {
  const Columns mine = report(planar, p, planar_works), full = report(spatial, s, spatial_works);
  ASSERT_EQ(mine.values().size(), full.values().size());
  for (std::size_t k = 0; k < mine.values().size(); ++k) {
    EXPECT_EQ(mine.values()[k].first, full.values()[k].first);
    EXPECT_NEAR(mine.values()[k].second, full.values()[k].second,
                tolerance * std::abs(full.values()[k].second))
        << mine.values()[k].first;
  }
}

TEST(PlanarForces, BeamsInLanes) {
  const Part part = partition(test::sheet(9, 7, 1), PETSC_COMM_SELF);
  const auto local = static_cast<std::size_t>(part.local);
  for (const Kinematics kinematics : {Kinematics::corotational, Kinematics::linear}) {
    for (const double damping : {0.0, 0.7}) {
      for (const double common : {0.0, 0.3, 2.0, 40.0}) {
        const bool linear = kinematics == Kinematics::linear;
        if (linear && common > 0) continue;
        const BeamOptions options{Shear::exact, kinematics, damping};
        const auto planar = make_beam_force<Planar>(part, options);
        const auto spatial = make_beam_force<Spatial>(part, options);
        for (const double turn : {1e-4, 0.1, 1.0}) {
          // An angle of `common` is known to its rounding, which shows against small strains.
          const double rounding = 1e-16 * common / turn;
          const State<Planar> state = deformed_in_plane(part, 0.1 * turn, turn, common);
          const State<Spatial> full = in_space(state, linear);
          Wrenches<Planar> w(local);
          Wrenches<Spatial> expected(local);
          planar->add(state, w);
          spatial->add(full, expected);
          EXPECT_LT(difference(w, expected, local), 1e-13 + rounding)
              << damping << ' ' << common << ' ' << turn;
          if (damping > 0) {
            EXPECT_LT(powers(*planar)[0], 0);
            EXPECT_NEAR(powers(*planar)[0] / powers(*spatial)[0], 1, 1e-12);
          }
          expect_same_report(*planar, state, *spatial, full, 1e-12 + rounding);
          EXPECT_EQ(planar->folded(state), spatial->folded(full));
          const auto a = planar->sections(state), b = spatial->sections(full);
          for (std::size_t m = 0; m < a.size(); ++m) {
            for (std::size_t k = 0; k < 6; ++k)
              EXPECT_NEAR(a[m][k], b[m][k], 1e-9 * std::abs(b[m][0]) + 1e-3) << m << ' ' << k;
          }
        }
      }
    }
  }
}

/// What tells that the stable step may have fallen: shears of one_point are alike in and out of the
/// plane, so both models have the same.
TEST(PlanarForces, FastestRateOfBeams) {
  const Part part = partition(test::sheet(9, 7, 1), PETSC_COMM_SELF);
  const BeamOptions options{Shear::one_point, Kinematics::corotational, 0};
  const auto planar = make_beam_force<Planar>(part, options);
  const auto spatial = make_beam_force<Spatial>(part, options);
  const State<Planar> rest(static_cast<std::size_t>(part.local));
  const State<Planar> state = deformed_in_plane(part, 0.5, 0.1, 2.0);
  const auto rate = rate_estimate(*planar, state);
  ASSERT_TRUE(rate.has_value());
  EXPECT_NEAR(*rate / rate_estimate(*spatial, in_space(state, false)).value(), 1, 1e-12);
  EXPECT_GT(*rate, 1.05 * rate_estimate(*planar, rest).value());
  const auto linear = make_beam_force<Planar>(part, {Shear::one_point, Kinematics::linear, 0});
  EXPECT_FALSE(rate_estimate(*linear, state).has_value());
}

/// The planar tangent is the in-plane part of the spatial one, in every storage.
TEST(PlanarForces, Tangents) {
  const Lattice lattice = test::sheet(4, 3, 1);
  const Part part = partition(lattice, PETSC_COMM_SELF);
  const auto local = static_cast<std::size_t>(part.local);
  Load load;
  load.name = "p", load.point = Point2{0.3, 0.2}, load.force = {3e5, -5e5, 0};
  load.moment = {0, 0, 1e5};
  const PlacedLoad placed = place(load, lattice);
  const auto beams = make_beam_force<Planar>(part, {});
  const auto spatial_beams = make_beam_force<Spatial>(part, {});
  const auto push = make_load<Planar>(part, placed);
  const auto spatial_push = make_load<Spatial>(part, placed);
  const State<Planar> state = deformed_in_plane(part, 0.1, 0.4, 0.7);
  const State<Spatial> full = in_space(state, false);
  const std::vector<std::uint8_t> held(local, 0);
  for (const TangentOptions& options :
       {TangentOptions{MATAIJ, true}, TangentOptions{MATSBAIJ, true},
        TangentOptions{MATAIJ, false}}) {
    Tangent<Planar> planar(part, held, 1.0, 0.0, options);
    Tangent<Spatial> spatial(part, held, 1.0, 0.0, options);
    planar.begin();
    spatial.begin();
    (void)add_tangent(*beams, state, planar);
    (void)add_tangent(*push, state, planar);
    (void)add_tangent(*spatial_beams, full, spatial);
    (void)add_tangent(*spatial_push, full, spatial);
    planar.end();
    spatial.end();
    const test::Dense mine = test::dense(planar.matrix()), all = test::dense(spatial.matrix());
    const std::vector<double> expected =
        test::in_plane({all.data(), all.data() + all.size()}, local);
    EXPECT_LT(
        (mine - Eigen::Map<const test::Dense>(expected.data(), mine.rows(), mine.cols())).norm(),
        1e-13 * mine.norm());
  }
}

TEST(PlanarForces, Loads) {
  const Lattice lattice = test::sheet(4, 3, 1);
  const Part part = partition(lattice, PETSC_COMM_SELF);
  const auto local = static_cast<std::size_t>(part.local);
  Load at_point, on_set;
  at_point.point = Point2{0.3, 0.2}, at_point.force = {3, -5, 0}, at_point.moment = {0, 0, 4};
  on_set.set = "left", on_set.force = {1, 2, 0}, on_set.moment = {0, 0, -3},
  on_set.ramp.seconds = 2;
  for (const Load& load : {at_point, on_set}) {
    for (const Kinematics kinematics : {Kinematics::corotational, Kinematics::linear}) {
      const bool linear = kinematics == Kinematics::linear;
      const auto planar = make_load<Planar>(part, place(load, lattice), kinematics);
      const auto spatial = make_load<Spatial>(part, place(load, lattice), kinematics);
      // Along a path, on which the load does work.
      State<Planar> before(local);
      std::vector<double> works(1), spatial_works(1);
      for (const double time : {0.5, 1.0, 1.7}) {
        State<Planar> state = deformed_in_plane(part, 0.1 * time, (linear ? 1e-6 : 0.4) * time);
        state.time = time;
        const State<Spatial> full = in_space(state, linear);
        Wrenches<Planar> w(local);
        Wrenches<Spatial> expected(local);
        planar->add(state, w);
        spatial->add(full, expected);
        EXPECT_LT(difference(w, expected, local), 1e-15);
        EXPECT_NEAR(powers(*planar)[0] / powers(*spatial)[0], 1, 1e-13);
        planar->roles().work->add_works(before, state, works);
        spatial->roles().work->add_works(in_space(before, linear), full, spatial_works);
        EXPECT_NE(works[0], 0);
        expect_same_report(*planar, state, *spatial, full, 1e-12, works, spatial_works);
        before = state;
      }
    }
  }
}

TEST(PlanarForces, Drag) {
  const Part part = partition(test::sheet(5, 4, 1), PETSC_COMM_SELF);
  const auto local = static_cast<std::size_t>(part.local);
  for (const DragOptions& options :
       {DragOptions{500, 0, 1010, {0, 0, 0}}, DragOptions{20, 1.2, 1010, {0.3, -0.2, 0}}}) {
    const auto planar = make_drag<Planar>(part, options);
    const auto spatial = make_drag<Spatial>(part, options);
    const State<Planar> state = deformed_in_plane(part, 0.3, 0.5, 1);
    const State<Spatial> full = in_space(state, false);
    Wrenches<Planar> w(local);
    Wrenches<Spatial> expected(local);
    planar->add(state, w);
    spatial->add(full, expected);
    EXPECT_LT(difference(w, expected, local), 1e-14);
    std::vector<double> works(1), spatial_works(1);
    LeapfrogWork<Planar> steps(std::span(&planar, 1), works);
    LeapfrogWork<Spatial> spatial_steps(std::span(&spatial, 1), spatial_works);
    steps.take_powers();
    steps.take_step(state, 0.1);
    spatial_steps.take_powers();
    spatial_steps.take_step(full, 0.1);
    EXPECT_NE(works[0], 0);
    expect_same_report(*planar, state, *spatial, full, 1e-12, steps.works(), spatial_steps.works());
  }
}

TEST(PlanarModel, PrescribesWhatLiesInThePlane) {
  Lattice lattice = test::row(3);
  Boundary held, moved;
  held.name = "held", held.set = "first", held.fixed = {false, true, true, true, false, true};
  held.velocity = Point3{0, 2, 0}, held.angular_velocity = {0, 0, 3};
  moved.name = "moved", moved.set = "last", moved.fixed[0] = moved.fixed[4] = true;
  moved.displacement = Point3{5, 0, 0}, moved.ramp.seconds = 2;
  Model<Planar> model(lattice, PETSC_COMM_SELF, {held, moved});
  EXPECT_EQ((std::vector<std::uint8_t>{model.prescribed().begin(), model.prescribed().end()}),
            (std::vector<std::uint8_t>{0b110, 0, 0b001}));
  std::vector<double> values(9, 0.0);
  model.prescribe(1.0, values);
  EXPECT_EQ(values, (std::vector<double>{0, 2, 3, 0, 0, 0, 2.5, 0, 0}));
  model.pin({{1, 0}, {1, 2}, {2, 5}});
  EXPECT_EQ((std::vector<std::uint8_t>{model.held().begin(), model.held().end()}),
            (std::vector<std::uint8_t>{0b110, 0b001, 0b101}));
}

}  // namespace
}  // namespace floe
