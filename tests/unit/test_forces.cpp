// Gravity, loads, buoyancy and the lattice's beams: wrenches from potentials, tangents from
// wrenches; ramps.
#include <gtest/gtest.h>

#include "beams/beam_force.h"
#include "floe/base/petsc.h"
#include "floe/forces/boundary.h"
#include "forces/dead_load.h"
#include "forces/gravity.h"
#include "support/force_checks.h"
#include "support/lattices.h"
#include "support/roles.h"
#include "water/buoyancy.h"

namespace floe {
namespace {

using test::deformed;
using test::wrenches_of;

// -- ramps and boundaries
// ---------------------------------------------------------------------------

TEST(Ramp, RisesThenStays) {
  const Ramp ramp{4};
  EXPECT_EQ(ramp.value(-1), 0);
  EXPECT_EQ(ramp.value(0), 0);
  EXPECT_EQ(ramp.value(1), 0.25);
  EXPECT_EQ(ramp.value(4), 1);
  EXPECT_EQ(ramp.value(9), 1);
  const Ramp none{0};
  EXPECT_EQ(none.value(0), 1);
  EXPECT_EQ(none.value(3), 1);
}

TEST(Ramp, IntegralIsTheAreaUnderIt) {
  for (const double seconds : {0.0, 4.0}) {
    const Ramp ramp{seconds};
    for (const double time : {-1.0, 0.0, 1.0, 4.0, 4.5, 9.0}) {
      constexpr int parts = 9000;
      double sum = 0;
      for (int k = 0; k < parts && time > 0; ++k)
        sum += ramp.value(time * (k + 0.5) / parts) * time / parts;
      EXPECT_NEAR(ramp.integral(time), sum, 1e-6) << seconds << ' ' << time;
    }
  }
}

TEST(Boundary, PrescribesItsComponentsOnly) {
  Boundary moved;
  moved.fixed = {true, false, true, false, true, false};
  moved.displacement = Point3{3, 0, -1};
  moved.angular_velocity = {0, 0.5, 0};
  moved.ramp.seconds = 2;
  EXPECT_EQ(moved.value(0), (std::array<double, 6>{}));
  EXPECT_EQ(moved.value(1), (std::array<double, 6>{1.5, 0, -0.5, 0, 0.125, 0}));
  EXPECT_EQ(moved.value(5), (std::array<double, 6>{3, 0, -1, 0, 2, 0}));
  Boundary driven = moved;
  driven.displacement.reset();
  driven.velocity = Point3{3, 0, -1};
  EXPECT_EQ(driven.value(1), (std::array<double, 6>{0.75, 0, -0.25, 0, 0.125, 0}));
  EXPECT_EQ(driven.value(5), (std::array<double, 6>{12, 0, -4, 0, 2, 0}));
}

// -- gravity
// ----------------------------------------------------------------------------------------

TEST(Gravity, WeightFromItsPotential) {
  const Part part = partition(test::row(3), PETSC_COMM_SELF);
  const auto gravity = make_gravity<Spatial>(part, 9.81);
  const State<Spatial> state = deformed(part, 1, 3);
  const std::vector<double> w = wrenches_of(*gravity, state);
  for (std::size_t k = 0; k < w.size(); ++k) EXPECT_EQ(w[k], k % 6 == 2 ? -2 * 9.81 : 0);
  test::expect_wrenches_from_potential(*gravity, state, 1e-3, 1e-10);
}

// -- loads
// ------------------------------------------------------------------------------------------

Load dead_load(const Point3& force, const Point3& moment, double ramp) {
  Load load;
  load.name = "p", load.set = "all", load.force = force, load.moment = moment,
  load.ramp.seconds = ramp;
  return load;
}

TEST(Load, SetSharesItEqually) {
  const Lattice lattice = test::row(4);
  const Part part = partition(lattice, PETSC_COMM_SELF);
  const auto load =
      make_load<Spatial>(part, place(dead_load({4, 8, 12}, {40, 80, 120}, 2), lattice));
  State<Spatial> state = deformed(part, 1, 3);
  for (const auto& [time, factor] : {std::pair{0.0, 0.0}, {1.0, 0.5}, {3.0, 1.0}}) {
    state.time = time;
    const std::vector<double> w = wrenches_of(*load, state);
    const std::array<double, 6> each{1, 2, 3, 10, 20, 30};
    for (std::size_t k = 0; k < w.size(); ++k) EXPECT_EQ(w[k], factor * each[k % 6]);
  }
}

TEST(Load, PointIsCarriedByTheNearestBodyStaticallyEquivalent) {
  const Lattice lattice = test::row(4);
  const Part part = partition(lattice, PETSC_COMM_SELF);
  Load load = dead_load({3, -5, 7}, {1, 2, 4}, 0);
  load.set.clear();
  load.point = Point2{2.2, 0.4};
  const PlacedLoad placed = place(load, lattice);
  ASSERT_EQ(placed.bodies, std::vector<std::int32_t>{2});
  const std::vector<double> w = wrenches_of(*make_load<Spatial>(part, placed), State<Spatial>(4));
  // About the origin: moment of the force at (2.2, 0.4, 0) and the applied moment.
  const Vec3<double> f{w[12], w[13], w[14]};
  const Vec3<double> moment = Vec3<double>{w[15], w[16], w[17]} + cross(Vec3<double>{2, 0, 0}, f);
  const Vec3<double> expected =
      Vec3<double>{1, 2, 4} + cross(Vec3<double>{2.2, 0.4, 0}, {3, -5, 7});
  EXPECT_EQ(f, (Vec3<double>{3, -5, 7}));
  EXPECT_NEAR(moment.x, expected.x, 1e-14);
  EXPECT_NEAR(moment.y, expected.y, 1e-14);
  EXPECT_NEAR(moment.z, expected.z, 1e-14);
}

TEST(Load, WrenchesFromPotentialAndTangent) {
  const Lattice lattice = test::row(2);
  const Part part = partition(lattice, PETSC_COMM_SELF);
  PlacedLoad placed = place(dead_load({3, -5, 7}, {0, 0, 0}, 0), lattice);
  placed.arm = {0.3, -0.2, 0.5};
  const auto load = make_load<Spatial>(part, placed);
  const State<Spatial> state = deformed(part, 1, 3);
  test::expect_wrenches_from_potential(*load, state, 1e-3, 1e-10);
  test::expect_tangent_from_wrenches(*load, part, state, 1e-3, 1e-10);
}

TEST(Load, WithLinearKinematicsIsConstant) {
  const Lattice lattice = test::row(2);
  const Part part = partition(lattice, PETSC_COMM_SELF);
  PlacedLoad placed = place(dead_load({3, -5, 7}, {0, 0, 0}, 0), lattice);
  placed.arm = {0.3, -0.2, 0.5};
  const auto load = make_load<Spatial>(part, placed, Kinematics::linear);
  State<Spatial> state(2), turned(2);
  for (std::size_t k = 4; k < 7; ++k) turned.record(1)[k] = 0.1 * static_cast<double>(k);
  const std::vector<double> w = wrenches_of(*load, state);
  EXPECT_EQ(wrenches_of(*load, turned), w);
  double work = 0;  // of the moment on theta = 2 (x, y, z)
  for (std::size_t k = 4; k < 7; ++k) work += 0.2 * static_cast<double>(k) * w[6 + k - 1];
  EXPECT_NEAR(test::potential_of(*load, turned), -work, 1e-14);
}

TEST(Load, DeadMomentChangesNoTangent) {
  const Lattice lattice = test::row(2);
  const Part part = partition(lattice, PETSC_COMM_SELF);
  const auto load = make_load<Spatial>(part, place(dead_load({0, 0, 0}, {1, 2, 3}, 0), lattice));
  const State<Spatial> state = deformed(part, 1, 3);
  EXPECT_EQ(test::jacobian_of(*load, state, 1e-3).norm(), 0);
  EXPECT_EQ(test::tangent_of(*load, part, state, {MATAIJ, false}).norm(), 0);
  EXPECT_EQ(test::potential_of(*load, state), 0);
}

TEST(Load, UnknownOrEmptySetIsRefused) {
  Lattice lattice = test::row(2);
  lattice.sets["nobody"] = {};
  for (const char* set : {"edge", "nobody"}) {
    Load load = dead_load({1, 0, 0}, {0, 0, 0}, 0);
    load.set = set;
    try {
      (void)place(load, lattice);
      ADD_FAILURE() << set;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(set), std::string::npos) << error.what();
    }
  }
}

// -- buoyancy
// ---------------------------------------------------------------------------------------

constexpr double water = 1010 * 9.81;

/// A floating sheet of few bodies and its buoyancy.
struct Floating {
  Lattice lattice = test::sheet(3, 3, 1.5, true);
  Part part = partition(lattice, PETSC_COMM_SELF);
  std::unique_ptr<Force<Spatial>> buoyancy = make_buoyancy<Spatial>(part, water);
};

TEST(Buoyancy, CarriesTheSheetAtItsDraft) {
  const Floating f;
  const std::vector<double> w =
      wrenches_of(*f.buoyancy, State<Spatial>(static_cast<std::size_t>(f.part.local)));
  for (std::size_t b = 0; b < f.lattice.bodies.mass.size(); ++b) {
    const double weight = 9.81 * f.lattice.bodies.mass[b];
    EXPECT_NEAR(w[6 * b + 2] / weight, 1, 1e-12);
    for (const std::size_t k : {0U, 1U, 3U, 4U, 5U}) EXPECT_NEAR(w[6 * b + k] / weight, 0, 1e-12);
  }
}

TEST(Buoyancy, WrenchesFromPotentialAndTangent) {
  const Floating f;
  for (const double turn : {1e-3, 0.3, 3.0}) {  // only the sides cut; corners dipped; upside down
    const State<Spatial> state = deformed(f.part, 0.2, turn);
    test::expect_wrenches_from_potential(*f.buoyancy, state, 1e-4, 1e-8);
    test::expect_tangent_from_wrenches(*f.buoyancy, f.part, state, 1e-5, 1e-6);
  }
}

TEST(Buoyancy, SubmergedAndAirborneBodies) {
  const Floating f;
  for (const double height : {-2.0, 2.0}) {
    State<Spatial> state = deformed(f.part, 0.2, 3.0);
    for (std::size_t b = 0; b < f.lattice.bodies.mass.size(); ++b) state.record(b)[2] += height;
    const std::vector<double> w = wrenches_of(*f.buoyancy, state);
    for (std::size_t b = 0; b < f.lattice.bodies.mass.size(); ++b) {
      const double displaced = height < 0 ? water / 920 * f.lattice.bodies.mass[b] : 0;
      EXPECT_NEAR(w[6 * b + 2], displaced, 1e-11 * water);
      for (const std::size_t k : {0U, 1U, 3U, 4U, 5U}) EXPECT_NEAR(w[6 * b + k], 0, 1e-11 * water);
    }
    if (height > 0) {
      EXPECT_EQ(test::potential_of(*f.buoyancy, state), 0);
    } else {
      test::expect_wrenches_from_potential(*f.buoyancy, state, 1e-3, 1e-9);
      const test::Dense k = test::tangent_of(*f.buoyancy, f.part, state, {MATAIJ, false});
      EXPECT_LT(k.norm(), 1e-10 * water);
    }
  }
}

TEST(Buoyancy, RotationAboutTheVerticalIsFree) {
  const Floating f;
  const State<Spatial> state = deformed(f.part, 0.2, 0.5);
  State<Spatial> turned = state;
  for (std::size_t b = 0; b < f.lattice.bodies.mass.size(); ++b) test::move(turned, b, 5, 1.3);
  const std::vector<double> before = wrenches_of(*f.buoyancy, state),
                            after = wrenches_of(*f.buoyancy, turned);
  const Quat<double> q = exp_rotation({0, 0, 1.3});
  for (std::size_t b = 0; b < f.lattice.bodies.mass.size(); ++b) {
    const Vec3<double> moment =
        rotate(q, {before[6 * b + 3], before[6 * b + 4], before[6 * b + 5]});
    EXPECT_NEAR(after[6 * b + 2], before[6 * b + 2], 1e-12 * water);
    EXPECT_NEAR(after[6 * b + 3], moment.x, 1e-12 * water);
    EXPECT_NEAR(after[6 * b + 4], moment.y, 1e-12 * water);
  }
}

TEST(Buoyancy, NeedsShapes) {
  const Part part = partition(test::row(2), PETSC_COMM_SELF);
  EXPECT_THROW((void)make_buoyancy<Spatial>(part, water), InputError);
}

// -- beams of a lattice, held unknowns
// --------------------------------------------------------------

/// Four bodies in space, joined by five beams.
Lattice tripod() {
  return test::frame({{0, 0, 0}, {1.2, 0.1, 0}, {0.4, 1.1, 0.2}, {0.5, 0.4, 1.3}},
                     {{0, 1}, {0, 3}, {1, 2}, {1, 3}, {2, 3}});
}

TEST(BeamsOfALattice, WrenchesFromPotentialAndTangent) {
  const Lattice lattice = tripod();
  const Part part = partition(lattice, PETSC_COMM_SELF);
  for (const Shear shear : {Shear::one_point, Shear::exact, Shear::none}) {
    const auto beams = make_beam_force<Spatial>(part, {shear, Kinematics::corotational});
    const State<Spatial> state = deformed(part, 0.1, 1.2);
    test::expect_wrenches_from_potential(*beams, state, 1e-3, 1e-9);
    test::expect_tangent_from_wrenches(*beams, part, state, 1e-3, 1e-9);
  }
}

TEST(BeamsOfALattice, BoundCoversTheTranslationalStiffness) {
  const Lattice lattice = tripod();
  const Part part = partition(lattice, PETSC_COMM_SELF);
  const auto beams = make_beam_force<Spatial>(part, {});
  const test::Dense k = test::tangent_of(*beams, part, State<Spatial>(4), {MATAIJ, true});
  for (std::int32_t b = 0; b < 4; ++b) {
    EXPECT_GT(stiffness_bound(*beams, b), 0);
    for (int c = 0; c < 3; ++c) EXPECT_LE(k(6 * b + c, 6 * b + c), stiffness_bound(*beams, b));
  }
}

/// Body 0 held whole, y and ry of body 2, rotations times 2 m.
TEST(Tangent, HeldUnknownsAreTakenOutAndLiftedToTheRightHandSide) {
  const Lattice lattice = tripod();
  const Part part = partition(lattice, PETSC_COMM_SELF);
  const auto beams = make_beam_force<Spatial>(part, {});
  const State<Spatial> state = deformed(part, 0.1, 0.5);
  const test::Dense whole = test::tangent_of(*beams, part, state, {MATAIJ, true});
  const std::vector<std::uint8_t> held{0b111111, 0, 0b010010, 0};
  const auto is_held = [&](Eigen::Index k) {
    return (held[static_cast<std::size_t>(k / 6)] >> (k % 6) & 1) != 0;
  };
  constexpr double scale = 2, diagonal = 77;
  std::vector<double> increments(24, 0.0);
  for (std::size_t k = 0; k < 24; ++k) increments[k] = 0.01 * static_cast<double>(k + 1);
  for (const char* type : {MATAIJ, MATSBAIJ}) {
    Tangent<Spatial> tangent(part, held, scale, diagonal, {type, true});
    tangent.begin(increments);
    ASSERT_TRUE(add_tangent(*beams, state, tangent));
    tangent.end();
    const test::Dense k = test::dense(tangent.matrix());
    for (Eigen::Index r = 0; r < 24; ++r) {
      double lift = 0;
      for (Eigen::Index c = 0; c < 24; ++c) {
        const double entry = whole(r, c) / ((r % 6 < 3 ? 1 : scale) * (c % 6 < 3 ? 1 : scale));
        const bool out = is_held(r) || is_held(c);
        EXPECT_NEAR(k(r, c), out ? (r == c ? diagonal : 0) : entry, 1e-15 * whole.norm());
        if (!is_held(r) && is_held(c)) lift += entry * increments[static_cast<std::size_t>(c)];
      }
      EXPECT_NEAR(tangent.lift()[static_cast<std::size_t>(r)], lift, 1e-14 * whole.norm());
    }
  }
}

}  // namespace
}  // namespace floe
