// The submerged part of bodies: the closed form of prisms against the clipped polyhedron.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "submersion/immersion.h"
#include "support/lattices.h"
#include "support/record.h"
#include "support/states.h"
#include "water/buoyancy.h"

namespace floe {
namespace {

/// Largest difference over the sizes that such a body's integrals have.
double difference(const Submerged& a, const Submerged& b, double size) {
  double largest = 0;
  const auto compare = [&](double x, double y, int power) {
    largest = std::max(largest, std::abs(x - y) / std::pow(size, power));
  };
  compare(a.volume, b.volume, 3);
  for (std::size_t k = 0; k < 3; ++k) compare(a.moment[k], b.moment[k], 4);
  compare(a.waterplane, b.waterplane, 2);
  compare(a.wx, b.wx, 3), compare(a.wy, b.wy, 3);
  compare(a.wxx, b.wxx, 4), compare(a.wxy, b.wxy, 4), compare(a.wyy, b.wyy, 4);
  return largest;
}

TEST(Immersion, ClosedFormIsTheClippedPolyhedron) {
  const Lattice lattice = test::sheet(12, 9, 1.5, true);
  const Part part = partition(lattice, PETSC_COMM_SELF);
  const Immersion immersion(part);
  test::Random random(7);
  double largest = 0;
  int cut = 0;
  for (const double tilt : {0.0, 1e-6, 1e-3, 0.02, 0.1, 1.0, 3.0}) {
    for (int trial = 0; trial < 50; ++trial) {
      State<Spatial> state(static_cast<std::size_t>(part.local));
      for (std::int32_t body = 0; body < part.owned; ++body) {
        const auto b = static_cast<std::size_t>(body);
        const Vec3<double> u = random.vector(0.25);
        double* r = state.record(b);
        r[0] = u.x, r[1] = u.y, r[2] = u.z;
        // About the vertical by anything, then tilted.
        const Quat<double> turn = exp_rotation({0, 0, random.uniform(-3, 3)});
        test::put_rotation(state, b, product(random.rotation(tilt), turn));
        const Submerged exact = immersion.by_clipping(state, body);
        largest = std::max(largest, difference(immersion.of(state, body), exact, 1.5));
        cut += exact.waterplane > 0 ? 1 : 0;
      }
    }
  }
  EXPECT_GT(cut, 1000);
  EXPECT_LT(largest, 1e-12);
  test::report({.section = "Water",
                .quantity = "closed form of a prism against the clipped polyhedron",
                .value = largest,
                .note = "largest difference of volume, centre, waterplane and its moments over the "
                        "body's size"});
}

/// Blocks in which all, some or none of the bodies are cut at their sides only, to the last bit.
TEST(Immersion, LanesAreTheScalarForm) {
  // An odd number of bodies: the last block is partly filled, whatever the number of lanes.
  const Lattice lattice = [] {
    for (double length = 9;; length += 0.5) {
      Lattice sheet = test::sheet(length, 9, 1.5, true);
      if (sheet.bodies.size() % 2 == 1) return sheet;
    }
  }();
  const Part part = partition(lattice, PETSC_COMM_SELF);
  ASSERT_NE(static_cast<std::size_t>(part.owned) % lanes, 0U);
  const Immersion immersion(part);
  for (const double turn : {0.0, 1e-3, 0.05, 0.5}) {
    const State<Spatial> state = test::deformed(part, turn, turn);
    for (std::size_t block = 0; block < immersion.blocks(); ++block) {
      const BlockMotion m = block_motion<true>(immersion, state, block);
      const Immersion::Lane below = immersion.of_block(state, block, m.u.z, m.q);
      for (std::size_t lane = 0; lane < lanes; ++lane) {
        const auto body = static_cast<std::int32_t>(immersion.body_of(block, lane));
        const Submerged s = immersion.of(state, body);
        EXPECT_EQ(below.volume[lane], s.volume);
        EXPECT_EQ(below.moment.x[lane], s.moment[0]);
        EXPECT_EQ(below.moment.y[lane], s.moment[1]);
        EXPECT_EQ(below.moment.z[lane], s.moment[2]);
      }
    }
  }
}

TEST(Immersion, EveryCellOfASheetIsAPrism) {
  const Lattice lattice = test::sheet(160, 40, 1.5, true);
  const Part part = partition(lattice, PETSC_COMM_SELF);
  const Immersion immersion(part);
  for (std::int32_t body = 0; body < part.owned; ++body) {
    ASSERT_TRUE(immersion.is_prism(body)) << body;
    const double volume = lattice.bodies.mass[static_cast<std::size_t>(body)] / 920;
    EXPECT_NEAR(immersion.volume(body) / volume, 1, 1e-12);
    EXPECT_NEAR(immersion.plan_area(body) * 0.5 / volume, 1, 1e-12);
  }
}

/// A unit cube sheared in x by its height, and a frustum: no prisms along axis 3.
TEST(Immersion, OtherBodiesAreClipped) {
  for (const bool frustum : {false, true}) {
    Lattice one = test::frame({{0, 0, 0}}, {});
    for (const double z : {-0.5, 0.5}) {
      for (const auto& [x, y] : {std::pair{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}}) {
        const double scale = frustum && z > 0 ? 0.5 : 1.0;
        one.shapes.vertices.push_back({x * scale + (frustum ? 0.0 : z), y * scale, z});
      }
    }
    one.shapes.corners = {3, 2, 1, 0, 4, 5, 6, 7, 0, 1, 5, 4, 1, 2, 6, 5, 2, 3, 7, 6, 3, 0, 4, 7};
    one.shapes.corner_of = {0, 4, 8, 12, 16, 20, 24};
    one.shapes.face_of = {0, 6};
    one.shapes.vertex_of = {0, 8};
    const Part part = partition(one, PETSC_COMM_SELF);
    const Immersion immersion(part);
    EXPECT_FALSE(immersion.is_prism(0));
    EXPECT_NEAR(immersion.plan_area(0), frustum ? 1.0 : 2.0, 1e-15);
    State<Spatial> state(1);
    EXPECT_NEAR(immersion.of(state, 0).volume, frustum ? (1 - 0.75 * 0.75 * 0.75) / 0.5 / 3 : 0.5,
                1e-14);
    state.record(0)[2] = 2;
    EXPECT_EQ(immersion.of(state, 0).volume, 0);
    state.record(0)[2] = -2;
    test::put_rotation(state, 0, exp_rotation({1, 2, 3}));
    EXPECT_LT(difference(immersion.of(state, 0), immersion.by_clipping(state, 0), 1), 1e-14);
  }
}

TEST(Immersion, DisplacedMassIsThatOfAFloatingSheet) {
  const Lattice lattice = test::sheet(12, 9, 1.5, true);
  const Part part = partition(lattice, PETSC_COMM_SELF);
  const std::vector<double> displaced = displaced_mass(part, 1010);
  for (std::size_t b = 0; b < displaced.size(); ++b)
    EXPECT_NEAR(displaced[b] / part.bodies.mass[b], 1, 1e-12);
}

}  // namespace
}  // namespace floe
