// Nothing depends on the number of ranks: mesh, forces (bit for bit), tension modulus, output
// order.
#include <gtest/gtest.h>

#include <cmath>

#include <algorithm>
#include <cstring>

#include "floe/base/petsc.h"
#include "forces/dead_load.h"
#include "forces/gravity.h"
#include "model/model.h"
#include "output/gather.h"
#include "statics/quasistatic.h"
#include "support/lattices.h"
#include "support/states.h"
#include "water/buoyancy.h"

namespace floe {
namespace {

Lattice floating_sheet() {
  Lattice s = test::sheet(12, 9, 1, true);
  reorder(s);
  return s;
}

/// A model with every force there is, on all ranks or on this one alone.
struct Everything {
  Model<Spatial> model;
  Everything(const Lattice& lattice, MPI_Comm comm) : model(lattice, comm, {}) {
    const Part& part = model.part();
    model.set_beams(make_beam_force<Spatial>(part, {Shear::exact, Kinematics::corotational}),
                    Kinematics::corotational);
    model.add_force(make_gravity<Spatial>(part, 9.81));
    model.add_force(make_buoyancy<Spatial>(part, 1010 * 9.81));
    Load on_set, at_point;
    on_set.name = "edge", on_set.set = "left", on_set.force = {1e5, 2e5, 3e5};
    at_point.name = "point", at_point.point = Point2{1.3, 0.2}, at_point.force = {0, 0, -1e4};
    for (const Load& load : {on_set, at_point})
      model.add_force(make_load<Spatial>(part, place(load, lattice)));
  }
};

TEST(Ranks, LatticeIsTheSameBitForBit) {
  SheetPlan plan;
  plan.length = 12, plan.width = 9, plan.element_size = 1, plan.iterations = 20;
  Lattice together = make_sheet(tessellate(plan, PETSC_COMM_WORLD), {}),
          alone = make_sheet(tessellate(plan, MPI_COMM_SELF), {});
  EXPECT_EQ(reorder(together), reorder(alone));
  EXPECT_EQ(together.bodies.position, alone.bodies.position);
  EXPECT_EQ(together.bodies.inertia, alone.bodies.inertia);
  EXPECT_EQ(together.beams.bodies, alone.beams.bodies);
  EXPECT_EQ(together.beams.width, alone.beams.width);
  EXPECT_EQ(together.shapes.vertices, alone.shapes.vertices);
}

/// Strips along x have the whole length, and their share of the width.
TEST(Ranks, StripsRunTowardsWhereTheWorkGathers) {
  const Lattice lattice = test::sheet(6, 30, 1, true);
  const auto extent = [&](const Part& part) {
    Vec3<double> low = part.bodies.position[0], high = low;
    for (std::size_t b = 0; b < static_cast<std::size_t>(part.owned); ++b) {
      const Point3& x = part.bodies.position[b];
      low = {std::min(low.x, x.x), std::min(low.y, x.y), 0};
      high = {std::max(high.x, x.x), std::max(high.y, x.y), 0};
    }
    return high - low;
  };
  const Part part = partition(lattice, PETSC_COMM_WORLD, Vec3<double>{-3, 0, 7});
  const Vec3<double> strip = extent(part);
  EXPECT_NEAR(strip.x, 5, 1.1);
  EXPECT_NEAR(strip.y, 29.0 / size(), 1.5);
  EXPECT_NEAR(part.owned, part.global_bodies / size(), 1);
  // Along y strips of two ranks would be too narrow, a direction without a part in plan is none:
  // both are as without one.
  const Part curve = partition(lattice, PETSC_COMM_WORLD);
  EXPECT_EQ(partition(lattice, PETSC_COMM_WORLD, Vec3<double>{0, 0, 1}).global, curve.global);
  if (size() > 1) {
    EXPECT_EQ(partition(lattice, PETSC_COMM_WORLD, Vec3<double>{0, 1, 0}).global, curve.global);
  }
}

class EveryDivision : public testing::TestWithParam<Vec3<double>> {};
INSTANTIATE_TEST_SUITE_P(Ranks, EveryDivision,
                         testing::Values(Vec3<double>{}, Vec3<double>{1, 0, 0}));

TEST_P(EveryDivision, OwnsEveryBodyOnceAndCountsEveryBeamOnce) {
  const Lattice lattice = floating_sheet();
  const Part part = partition(lattice, PETSC_COMM_WORLD, GetParam());
  std::vector<int> owners(lattice.bodies.mass.size(), 0), counts(lattice.beams.area.size(), 0);
  for (std::int32_t b = 0; b < part.owned; ++b)
    ++owners[static_cast<std::size_t>(part.global[static_cast<std::size_t>(b)])];
  for (std::size_t m = 0; m < part.counts_here.size(); ++m)
    counts[static_cast<std::size_t>(part.global_beam[m])] += part.counts_here[m];
  for (auto* list : {&owners, &counts}) {
    MPI_Allreduce(MPI_IN_PLACE, list->data(), static_cast<int>(list->size()), MPI_INT, MPI_SUM,
                  PETSC_COMM_WORLD);
    EXPECT_EQ(*std::min_element(list->begin(), list->end()), 1);
    EXPECT_EQ(*std::max_element(list->begin(), list->end()), 1);
  }
  EXPECT_TRUE(std::is_sorted(part.global_beam.begin(), part.global_beam.end()));
  EXPECT_NEAR(part.owned, part.global_bodies / size(), 1);
}

TEST(Ranks, GhostsAreTheirOwnersRecords) {
  const Part part = partition(floating_sheet(), PETSC_COMM_WORLD);
  const State<Spatial> expected = test::deformed(part, 1, 3);
  State<Spatial> state = expected;
  const auto owned = static_cast<std::ptrdiff_t>(part.owned) * Spatial::record;
  std::fill(state.records.begin() + owned, state.records.end(), -77.0);
  part.ghosts.update(state.records, Spatial::record);
  EXPECT_EQ(state.records, expected.records);
  std::vector<double> number(static_cast<std::size_t>(part.local), -1);  // another width
  std::copy_n(part.global.begin(), part.owned, number.begin());
  part.ghosts.update(number, 1);
  EXPECT_TRUE(std::equal(number.begin(), number.end(), part.global.begin()));
}

TEST(Ranks, ForcesAreTheSameBitForBit) {
  const Lattice lattice = floating_sheet();
  const Everything together(lattice, PETSC_COMM_WORLD), alone(lattice, PETSC_COMM_SELF);
  const Part &part = together.model.part(), &whole = alone.model.part();
  Wrenches<Spatial> here(static_cast<std::size_t>(part.local)),
      all(static_cast<std::size_t>(whole.local));
  for (const double turn : {1e-3, 1.0}) {
    together.model.evaluate(test::deformed(part, 0.3, turn), here);
    alone.model.evaluate(test::deformed(whole, 0.3, turn), all);
    for (std::int32_t b = 0; b < part.owned; ++b) {
      const std::int32_t g = whole.local_index(part.global[static_cast<std::size_t>(b)]);
      EXPECT_EQ(std::memcmp(here.of(static_cast<std::size_t>(b)),
                            all.of(static_cast<std::size_t>(g)), 6 * sizeof(double)),
                0)
          << "body " << part.global[static_cast<std::size_t>(b)];
    }
  }
}

TEST(Ranks, EnergiesAreTheSame) {
  const Lattice lattice = floating_sheet();
  const Everything together(lattice, PETSC_COMM_WORLD), alone(lattice, PETSC_COMM_SELF);
  const std::vector<double> works{3.0 / size(PETSC_COMM_WORLD)}, all_works{3};  // of the load
  const auto a = together.model.report(test::deformed(together.model.part(), 0.3, 1), works);
  const auto b = alone.model.report(test::deformed(alone.model.part(), 0.3, 1), all_works);
  ASSERT_EQ(a.size(), 5U);  // strain, gravity, water, load, external
  for (std::size_t k = 0; k < a.size(); ++k) {
    EXPECT_EQ(a[k].first, b[k].first);
    EXPECT_NEAR(a[k].second, b[k].second, 1e-12 * std::abs(b[k].second)) << a[k].first;
  }
}

TEST(Ranks, GatherGivesGlobalOrder) {
  const Part part = partition(floating_sheet(), PETSC_COMM_WORLD);
  const Gather gather(part.comm, std::span(part.global).first(static_cast<std::size_t>(part.owned)),
                      part.global_bodies);
  std::vector<std::array<double, 2>> rows;
  for (std::int32_t b = 0; b < part.owned; ++b) {
    const double g = part.global[static_cast<std::size_t>(b)];
    rows.push_back({g, -g});
  }
  const std::vector<std::array<double, 2>> all = gather(rows);
  ASSERT_EQ(all.size(), rank() == 0 ? static_cast<std::size_t>(part.global_bodies) : 0U);
  for (std::size_t k = 0; k < all.size(); ++k) {
    EXPECT_EQ(all[k][0], static_cast<double>(k));
    EXPECT_EQ(all[k][1], -static_cast<double>(k));
  }
}

/// Force on the left bodies of a stretched sheet [N].
double tension(const Lattice& lattice, MPI_Comm comm) {
  Boundary left, right;
  left.name = left.set = "left", right.name = right.set = "right";
  left.fixed[0] = right.fixed[0] = true;
  right.displacement = Point3{0.012, 0, 0};
  Model<Spatial> model(lattice, comm, {left, right});
  model.set_beams(make_beam_force<Spatial>(model.part(), {}), Kinematics::corotational);
  model.pin(free_motions(lattice, prescribed_components(lattice, {left, right}), {}).pins);
  double force = 0;
  const RunResult result = run_quasistatic(model, {}, [&](const Accepted<Spatial>& accepted) {
    force = 0;
    for (const std::int32_t b : model.part().localise(lattice.sets.at("left"))) {
      if (b < model.part().owned) force += accepted.wrenches.of(static_cast<std::size_t>(b))[0];
    }
  });
  EXPECT_TRUE(result.done) << result.message;
  MPI_Allreduce(MPI_IN_PLACE, &force, 1, MPI_DOUBLE, MPI_SUM, comm);
  return force;
}

TEST(Ranks, TensionGivesTheSameModulus) {
  Lattice lattice = test::sheet(12, 12, 1);
  reorder(lattice);
  const double together = tension(lattice, PETSC_COMM_WORLD),
               alone = tension(lattice, PETSC_COMM_SELF);
  EXPECT_GT(alone, 0);
  EXPECT_NEAR(together / alone, 1, 1e-10);
}

TEST(Ranks, MoreRanksThanBodiesIsRefused) {
  if (size() == 1) GTEST_SKIP();
  EXPECT_THROW((void)partition(test::row(size() - 1), PETSC_COMM_WORLD), InputError);
  EXPECT_NO_THROW((void)partition(test::row(size()), PETSC_COMM_WORLD));
}

}  // namespace
}  // namespace floe
