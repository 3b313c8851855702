// A leapfrog step of bodies in lanes against the same step of one body.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "leapfrog/rigid_body_step_lanes.h"
#include "support/random.h"

namespace floe {
namespace {

using test::Random;

struct Body {
  BodyConstants<double> constants;
  BodyMotion<double> motion;
  Vec3<double> force, moment;
};

/// \param turn  about how far it turns in a step [rad], for a step of 1 s
Body random_body(Random& random, double turn) {
  const Vec3<double> inertia{random.uniform(1, 2), random.uniform(1, 2), random.uniform(1, 2)};
  Body b{{random.uniform(0.5, 2),
          {1 / inertia.x, 1 / inertia.y, 1 / inertia.z},
          random.rotation(random.uniform(0, 3))},
         {random.vector(1),
          random.rotation(random.uniform(0, 3)),
          random.vector(1),
          {},
          turn * random.direction()},
         random.vector(1),
         random.vector(0.1 * turn)};
  return b;
}

template <class T>
std::vector<T*> numbers(BodyMotion<T>& m) {
  return {&m.u.x, &m.u.y, &m.u.z, &m.q.w, &m.q.x, &m.q.y,        &m.q.z,        &m.v.x,
          &m.v.y, &m.v.z, &m.w.x, &m.w.y, &m.w.z, &m.momentum.x, &m.momentum.y, &m.momentum.z};
}

BodyMotion<Lanes> step(const std::vector<Body>& bodies) {
  const auto all = [&](auto number) {
    return Lanes([&](auto lane) { return number(bodies[lane]); });
  };
#define FLOE_ALL(member) all([](const Body& b) { return b.member; })
#define FLOE_VECTOR(member) \
  { FLOE_ALL(member.x), FLOE_ALL(member.y), FLOE_ALL(member.z) }
#define FLOE_QUAT(member) \
  { FLOE_ALL(member.w), FLOE_ALL(member.x), FLOE_ALL(member.y), FLOE_ALL(member.z) }
  const BodyConstants<Lanes> constants{FLOE_ALL(constants.inverse_mass),
                                       FLOE_VECTOR(constants.inverse_inertia),
                                       FLOE_QUAT(constants.axes)};
  BodyMotion<Lanes> m{FLOE_VECTOR(motion.u), FLOE_QUAT(motion.q), FLOE_VECTOR(motion.v),
                      FLOE_VECTOR(motion.w), FLOE_VECTOR(motion.momentum)};
  const Vec3<Lanes> force FLOE_VECTOR(force), moment FLOE_VECTOR(moment);
#undef FLOE_ALL
#undef FLOE_VECTOR
#undef FLOE_QUAT
  leap<Lanes>(constants, m, force, moment, 1.0);
  return m;
}

// Numbers of order 1, each through some 30 operations.
constexpr double rounding_of_a_step = 30 * 2.2e-16;

TEST(BodyUpdate, InLanesIsThatOfOneBody) {
  Random random(2);
  for (const double turn : {1e-6, 1e-3, 0.02, 0.5}) {
    for (int repeat = 0; repeat < 50; ++repeat) {
      std::vector<Body> bodies;
      for (std::size_t lane = 0; lane < lanes; ++lane) bodies.push_back(random_body(random, turn));
      BodyMotion<Lanes> together = step(bodies);
      for (std::size_t lane = 0; lane < lanes; ++lane) {
        Body& b = bodies[lane];
        leap<double>(b.constants, b.motion, b.force, b.moment, 1.0);
        const std::vector<double*> expected = numbers(b.motion);
        const std::vector<Lanes*> found = numbers(together);
        for (std::size_t k = 0; k < expected.size(); ++k)
          EXPECT_NEAR((*found[k])[lane], *expected[k], rounding_of_a_step) << "number " << k;
      }
    }
  }
}

TEST(BodyUpdate, OfALaneDoesNotDependOnTheOthers) {
  Random random(3);
  for (int repeat = 0; repeat < 50; ++repeat) {
    std::vector<Body> bodies(lanes, random_body(random, 1e-3));
    BodyMotion<Lanes> alone = step(bodies);
    for (std::size_t other = 1; other < lanes; ++other) bodies[other] = random_body(random, 0.5);
    BodyMotion<Lanes> among = step(bodies);
    const std::vector<Lanes*> expected = numbers(alone), found = numbers(among);
    for (std::size_t k = 0; k < expected.size(); ++k)
      EXPECT_EQ((*found[k])[0], (*expected[k])[0]) << "number " << k;
  }
}

}  // namespace
}  // namespace floe
