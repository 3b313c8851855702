// Overlaps worked out by another rank are the same overlaps, to the last bit.

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "contact_force/load_balance.h"
#include "support/blocks.h"

namespace floe {
namespace {

TEST(SharedPairs, AreWorkedOutWhereThereIsTime) {
  const std::vector<std::int64_t> even{500, 510, 490}, one_sided{1500, 0}, three{1000, 100, 100};
  for (const auto& row : shared_pairs(even)) {
    for (const std::int64_t count : row) EXPECT_EQ(count, 0);
  }
  // 0.6 of the work of a pair can go: 1500 (0.4 + 0.6 x) = 0.6 * 1500 (1 - x), x = 1/6.
  EXPECT_NEAR(static_cast<double>(shared_pairs(one_sided)[0][1]), 1500 * 5 / 6.0, 1);
  const auto shares = shared_pairs(three);
  EXPECT_EQ(shares[0][1], shares[0][2]);
  const auto time = [](double pairs, double gone) { return pairs - 0.6 * gone; };
  EXPECT_NEAR(time(1000, static_cast<double>(shares[0][1] + shares[0][2])), 400, 2);
}

/// Turned blocks on a grid with a moving box among them, all of them on rank 0; the other ranks
/// have nothing to do. Two steps, so that there is a history.
struct Blocks {
  Lattice lattice;
  std::vector<MovingPose> moving;
  std::vector<Obstacle> obstacles{box({2, 2, 2}, {1, 2, 3}, {10, 20, 30})};
  Blocks() {
    test::Random random(5);
    for (int k = 0; k < 216; ++k) {
      const Vec3<double> x{0.9 * (k % 6), 0.9 * (k / 6 % 6), 0.9 * (k / 36)};
      const Quat<double> q = random.rotation(random.uniform(0, 1));
      test::append_block(lattice, {1, 1, 1}, x, q);
      moving.push_back({{x, q}, random.vector(1), random.vector(1)});
    }
    obstacles[0].motion.velocity = {0.1, 0.2, 0.3};
  }
  Contacts contacts() const {
    return {lattice.shapes,
            lattice.bodies.mass,
            {},
            {.young = 1e7, .friction = 0.3, .damping_ratio = 0.2},
            obstacles};
  }
  std::vector<Pose> poses() const {
    std::vector<Pose> poses;
    for (const MovingPose& m : moving) poses.push_back(m.pose);
    return poses;
  }
  std::vector<MovingPose> of(const Contacts& contacts) const {
    std::vector<MovingPose> bodies;
    for (const std::int32_t b : contacts.list().involved())
      bodies.push_back(moving[static_cast<std::size_t>(b)]);
    return bodies;
  }
};

TEST(ContactLoadBalance, ChangesNoForceAndNoHistory) {
  const Blocks blocks;
  const MPI_Comm comm = PETSC_COMM_WORLD;
  const bool here = rank(comm) == 0;
  const std::vector<std::uint8_t> all(blocks.moving.size(), 1),
      mine(blocks.moving.size(), here ? 1 : 0);
  Contacts alone = blocks.contacts(), shared = blocks.contacts();
  ContactLoadBalance with_none(PETSC_COMM_SELF), with_all(comm);
  std::vector<double> powers;
  const auto step = [&](Contacts& contacts, ContactLoadBalance& sharing,
                        const std::vector<std::uint8_t>& wanted) {
    contacts.build(blocks.poses(), wanted, 0);
    sharing.plan(contacts);
    const std::vector<MovingPose> bodies = blocks.of(contacts);
    std::vector<ContactWrench> wrenches(bodies.size());
    contacts.place(bodies, 0, -0.5e-4);  // friction's springs go on by a step of 1e-4 s
    sharing.evaluate(contacts, wrenches);
    std::vector<Acceleration> accelerations;
    for (std::size_t s = 0; s < wrenches.size(); ++s)
      accelerations.push_back(contacts.acceleration(static_cast<std::int32_t>(s), wrenches[s]));
    contacts.damp(accelerations, wrenches);
    ContactPower power;
    for (std::size_t s = 0; s < bodies.size(); ++s)
      contacts.add_power(static_cast<std::int32_t>(s), bodies[s].velocity, bodies[s].spin, power);
    powers.push_back(power.friction);
    contacts.add_power_on_obstacles(0.5e-4, power);
    powers.push_back(power.friction);
    contacts.commit();
    return wrenches;
  };
  for (int k = 0; k < 3; ++k) {
    powers.clear();
    const auto a = step(alone, with_none, all), b = step(shared, with_all, mine);
    if (size(comm) > 1 && k > 0) {
      EXPECT_GT(shared.list().involved().size(), 0U) << "nothing was shared";
    }
    if (!here) continue;
    ASSERT_GT(alone.history().size(), 400U);
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t s = 0; s < a.size(); ++s) {
      ASSERT_EQ(a[s].force.x, b[s].force.x) << s;
      ASSERT_EQ(a[s].force.z, b[s].force.z) << s;
      ASSERT_EQ(a[s].moment.y, b[s].moment.y) << s;
    }
    ASSERT_EQ(alone.history_rows(), shared.history_rows());
    EXPECT_EQ(powers[0], powers[2]);
    EXPECT_EQ(powers[1], powers[3]);
    EXPECT_EQ(alone.on_obstacle(0).moment.x, shared.on_obstacle(0).moment.x);
  }
}

}  // namespace
}  // namespace floe
