// What the list of pairs leaves out would not have touched.

#include <gtest/gtest.h>

#include "active_contacts/contacts.h"
#include "support/blocks.h"

namespace floe {
namespace {

/// Loose blocks that drift and turn at random, in a box that moves; without a history, so that a
/// list made long ago must say what a list made now says.
struct Crowd {
  Lattice lattice;
  std::vector<MovingPose> bodies;
  test::Random random{3};
  std::vector<Obstacle> obstacles{box({2, 2, 2}, {3, 1, 1}, {10, 20, 30}),
                                  half_space({0, 0, -0.6}, {0, 0, 1})};
  Crowd() {
    obstacles[0].motion.velocity = {0.3, 0.2, -0.1};
    obstacles[0].motion.angular_velocity = {0.2, -0.1, 0.3};
    for (int k = 0; k < 64; ++k) {
      const Vec3<double> x{1.3 * (k % 4), 1.3 * (k / 4 % 4), 1.3 * (k / 16)};
      const Quat<double> q = random.rotation(random.uniform(0, 3));
      test::append_block(lattice, {1, 1, 0.5}, x, q);
      bodies.push_back({{x, q}, {}, {}});
    }
  }
  void move(double step) {
    for (MovingPose& b : bodies) {
      b.pose.x = b.pose.x + random.vector(step);
      b.pose.q = normalised(product(random.rotation(random.uniform(0, step)), b.pose.q));
    }
  }
  Contacts contacts() const {
    Contacts made(lattice.shapes, lattice.bodies.mass, {}, {.young = 1e7, .friction = 0},
                  obstacles);
    return made;
  }
  void build(Contacts& contacts, double time) const {
    std::vector<Pose> poses;
    for (const MovingPose& b : bodies) poses.push_back(b.pose);
    contacts.build(poses, std::vector<std::uint8_t>(bodies.size(), 1), time);
  }
  /// Wrenches of all bodies.
  std::vector<ContactWrench> wrenches(Contacts& contacts, double time) const {
    std::vector<MovingPose> involved;
    for (const std::int32_t b : contacts.list().involved())
      involved.push_back(bodies[static_cast<std::size_t>(b)]);
    std::vector<ContactWrench> some(involved.size()), all(bodies.size());
    contacts.place(involved, time, time);
    contacts.evaluate(some);
    for (std::size_t s = 0; s < some.size(); ++s)
      all[static_cast<std::size_t>(contacts.list().involved()[s])] = some[s];
    return all;
  }
};

TEST(ContactList, NeverHidesATouch) {
  Crowd crowd;
  Contacts kept = crowd.contacts();
  int born = 0;
  std::int64_t before = 0;
  constexpr double step = 1e-3, dt = 3e-3;
  const int safe =
      static_cast<int>(kept.list().slack() / (4 * step));  // of steps between two lists
  for (int k = 0; k < 600; ++k) {
    const double time = k * dt;
    if (k % safe == 0) crowd.build(kept, time);
    Contacts fresh = crowd.contacts();
    crowd.build(fresh, time);
    const auto a = crowd.wrenches(kept, time), b = crowd.wrenches(fresh, time);
    ASSERT_EQ(kept.touching(), fresh.touching()) << k;
    for (std::size_t s = 0; s < a.size(); ++s) {
      ASSERT_EQ(a[s].force.x, b[s].force.x) << k << " " << s;
      ASSERT_EQ(a[s].moment.y, b[s].moment.y) << k << " " << s;
    }
    if (kept.touching() > before) ++born;
    before = kept.touching();
    crowd.move(step);
  }
  EXPECT_GT(born, 20);
}

/// Of two bodies one inside the other no way out is to be preferred: no force, but they are
/// counted.
TEST(ContactList, CountsBodiesInsideOthers) {
  Lattice lattice;
  test::append_block(lattice, {1, 1, 1}, {0, 0, 0});
  test::append_block(lattice, {0.2, 0.2, 0.2}, {0, 0, 0});
  for (const double z : {0.0, 0.39, 0.41}) {
    Contacts contacts(lattice.shapes, lattice.bodies.mass, {}, {.young = 1e7, .friction = 0}, {});
    const std::vector<MovingPose> bodies{{{{0, 0, 0}, {1, 0, 0, 0}}, {}, {}},
                                         {{{0, 0, z}, {1, 0, 0, 0}}, {}, {}}};
    contacts.build(std::vector{bodies[0].pose, bodies[1].pose}, std::vector<std::uint8_t>(2, 1), 0);
    std::vector<ContactWrench> wrenches(2);
    contacts.place(bodies, 0, 0);
    contacts.evaluate(wrenches);
    EXPECT_EQ(contacts.enclosed().size(), z < 0.4 ? 1U : 0U) << z;
    EXPECT_EQ(wrenches[1].force.z > 0, z > 0.4) << z;
  }
}

}  // namespace
}  // namespace floe
