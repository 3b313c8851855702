// When bodies move between ranks: the loads that forces count, and the decisions made of them.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numeric>

#include "base/collectives.h"
#include "beams/beam_force.h"
#include "model/rank_balance.h"
#include "support/lattices.h"
#include "water/buoyancy.h"

namespace floe::test {
namespace {

/// A force without wrenches, of which a number of bodies take a time.
class Busy final : public Force<Spatial>, public BearsLoad<Spatial> {
 public:
  /// \param bodies  the first so many of the lattice \param ns  of each
  Busy(const Part& part, std::int32_t bodies, double ns) : part_(part), bodies_(bodies), ns_(ns) {}
  std::string_view name() const override { return "busy"; }
  void add(const State<Spatial>&, Wrenches<Spatial>&) override {}
  void report(const State<Spatial>&, std::span<const double>, Columns&) const override {}
  Roles<Spatial> roles() override { return {.load = this}; }
  void add_load(const State<Spatial>&, std::span<double> load) const override {
    for (std::size_t b = 0; b < load.size(); ++b) {
      if (part_.global[b] < bodies_) load[b] += ns_;
    }
  }

 private:
  const Part& part_;
  std::int32_t bodies_;
  double ns_;
};

/// The bodies that rank 0 has at first take 1000 ns each.
class OfRank final : public Force<Spatial>, public BearsLoad<Spatial> {
 public:
  std::string_view name() const override { return "of rank 0"; }
  void add(const State<Spatial>&, Wrenches<Spatial>&) override {}
  void report(const State<Spatial>&, std::span<const double>, Columns&) const override {}
  Roles<Spatial> roles() override { return {.load = this}; }
  void add_load(const State<Spatial>&, std::span<double> load) const override {
    for (double& l : load) l += rank() == 0 ? 1e3 : 0.0;
  }
};

BalanceOptions options(double threshold, std::int64_t every) {
  return {.threshold = threshold, .every = every, .strips = {}, .divide = [](const auto&) {}};
}

State<Spatial> rest(const Model<Spatial>& model) {
  return State<Spatial>(static_cast<std::size_t>(model.part().local));
}

double all_loads(const Model<Spatial>& model) {
  const std::vector<double> mine = loads_of(model, rest(model));
  return sum_over_ranks(std::accumulate(mine.begin(), mine.end(), 0.0), model.part().comm);
}

class RankBalanced : public testing::Test {
 protected:
  Lattice lattice = sheet(12, 9, 1, true);
  Model<Spatial> model{lattice, PETSC_COMM_WORLD, {}};
};

/// Each beam is counted once, whatever the ranks: half with each of its bodies.
TEST_F(RankBalanced, BeamsLoadTheirBodies) {
  const double without = all_loads(model);
  model.set_beams(make_beam_force<Spatial>(model.part(), {}), Kinematics::corotational);
  const double a_beam =
      (all_loads(model) - without) / static_cast<double>(lattice.beams.bodies.size());
  EXPECT_GT(a_beam, 0);
  Model<Spatial> alone{lattice, PETSC_COMM_SELF, {}};
  const double before = all_loads(alone);
  alone.set_beams(make_beam_force<Spatial>(alone.part(), {}), Kinematics::corotational);
  EXPECT_NEAR((all_loads(alone) - before) / static_cast<double>(lattice.beams.bodies.size()),
              a_beam, 1e-9 * a_beam);
}

/// Bodies that the surface cuts through their end faces are clipped, floating ones are not.
TEST_F(RankBalanced, ClippedBodiesLoad) {
  const double without = all_loads(model);
  model.add_force(make_buoyancy<Spatial>(model.part(), 1010 * 9.81));
  EXPECT_EQ(all_loads(model), without);
  State<Spatial> state = rest(model);
  const double half = std::sqrt(0.5);
  for (std::int32_t b = 0; b < model.part().owned; ++b) {
    double* q = state.record(static_cast<std::size_t>(b)) + Spatial::displacement + 3;
    q[0] = half, q[1] = half;  // on edge
  }
  const std::vector<double> mine = loads_of(model, state);
  const double loads =
      sum_over_ranks(std::accumulate(mine.begin(), mine.end(), 0.0), model.part().comm);
  EXPECT_NEAR((loads - without) / model.part().global_bodies, 290, 1);
}

TEST_F(RankBalanced, MovesWhenRanksHaveWaitedLongerThanAMoveTakes) {
  if (size() == 1) GTEST_SKIP();
  model.add_force(std::make_unique<OfRank>());
  // Rank 0 has 1060 ns for each of its n/r bodies, the mean is (60 + 1000/r) n/r: per step it keeps
  // the others waiting for 1000 (1 - 1/r)/r ns per body of the lattice, and a move takes 60 us.
  const double r = size(), waits = 1e3 * (1 - 1 / r) / r;
  const auto looks = static_cast<std::int64_t>(std::ceil(60e3 / (waits * 50)));
  RankBalance balance(options(1.15, 50));
  for (std::int64_t k = 1; k < looks - 1; ++k)
    ASSERT_FALSE(balance.look(model, rest(model))) << k << " of " << looks;
  bool moved = false;
  for (int k = 0; k < 3 && !moved; ++k) moved = balance.look(model, rest(model)).has_value();
  EXPECT_TRUE(moved);
  EXPECT_EQ(balance.moves().count, 1);
  EXPECT_NEAR(balance.moves().before, 1060 / (60 + 1e3 / r), 0.1);
  EXPECT_NEAR(balance.moves().after, 1, 0.1);
  EXPECT_EQ(balance.owner().size(), static_cast<std::size_t>(model.part().global_bodies));
  // A threshold that is not exceeded.
  RankBalance calm(options(1060 / (60 + 1e3 / r) + 0.2, 50));
  for (std::int64_t k = 0; k < 2 * looks; ++k) EXPECT_FALSE(calm.look(model, rest(model)));
}

/// One body that does nearly all cannot be shared: no division is better, so none is made.
TEST_F(RankBalanced, DoesNotMoveInVain) {
  if (size() == 1) GTEST_SKIP();
  model.add_force(std::make_unique<Busy>(model.part(), 1, 1e9));
  RankBalance balance(options(1.15, 1000));
  for (int k = 0; k < 5; ++k) EXPECT_FALSE(balance.look(model, rest(model)));
  EXPECT_EQ(balance.moves().count, 0);
}

TEST_F(RankBalanced, LooksEverySoManySteps) {
  const RankBalance balance(options(1.15, 50));
  EXPECT_EQ(balance.next_look(0), 50);
  EXPECT_EQ(balance.next_look(49), 50);
  EXPECT_EQ(balance.next_look(50), 100);
  EXPECT_TRUE(balance.is_due(100));
  EXPECT_FALSE(balance.is_due(99));
  EXPECT_FALSE(balance.is_due(0));
  const RankBalance off(BalanceOptions{});
  EXPECT_FALSE(off.is_due(1000));
  EXPECT_EQ(off.next_look(0), std::numeric_limits<std::int64_t>::max());
}

/// Forces and part are gone and come again, at the same places in memory.
TEST_F(RankBalanced, AModelIsDividedAnew) {
  const Part* part = &model.part();
  std::vector<std::int32_t> owner(static_cast<std::size_t>(model.part().global_bodies));
  for (std::size_t b = 0; b < owner.size(); ++b) owner[b] = static_cast<std::int32_t>(b) % size();
  model.set_beams(make_beam_force<Spatial>(model.part(), {}), Kinematics::corotational);
  model.divide(lattice, owner);
  EXPECT_EQ(&model.part(), part);
  EXPECT_TRUE(model.forces().empty());
  EXPECT_EQ(model.beams(), nullptr);
  for (std::int32_t b = 0; b < part->owned; ++b)
    EXPECT_EQ(part->global[static_cast<std::size_t>(b)] % size(), rank());
  EXPECT_EQ(model.inertial_mass(), part->bodies.mass);
  EXPECT_EQ(model.prescribed().size(), static_cast<std::size_t>(part->local));
  EXPECT_EQ(sum_over_ranks(std::int64_t{part->owned}, part->comm), part->global_bodies);
}

}  // namespace
}  // namespace floe::test
