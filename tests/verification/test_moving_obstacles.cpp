// Obstacles on a given motion: ramps, turning, oscillation (model.md, "Contact").

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "support/contact_scene.h"
#include "support/record.h"

namespace floe {
namespace {

using test::append_obstacle;
using test::contact_scene;
using test::start;
using test::velocity;

constexpr double g = 9.81, density = 920, pi = std::numbers::pi;

/// A block that has sunk into a level floor by its weight.
struct Standing {
  Scene scene;
  Lattice lattice;
  double mass;
  Standing(const Vec3<double>& size, const Vec3<double>& foot, double friction, double young)
      : scene(contact_scene(young, friction, 0.3)), mass(density * size.x * size.y * size.z) {
    const double stiffness = young / (0.5 * std::cbrt(size.x * size.y * size.z));
    const double sunk = mass * g / (stiffness * size.x * size.y);
    test::append_block(lattice, size, foot + Vec3<double>{0, 0, 0.5 * size.z - sunk});
  }
  ObstacleMotion& floor() {
    return append_obstacle(scene, "floor", half_space({0, 0, 0}, {0, 0, 1})).motion;
  }
};

void run_to(test::Dynamics& d, double time) {
  while (d.state().time < time) (void)d.step();
}

/// What bodies and contacts have and have lost.
double kept_and_lost(const test::Dynamics& d) {
  return d.kinetic() + d.reported("energy_gravity") + d.reported("energy_contact") +
         d.reported("energy_contact_viscous") + d.reported("energy_friction") +
         d.reported("energy_crushing");
}

Vec3<double> reported(const test::Dynamics& d, const std::string& name) {
  return {d.reported(name + "_x"), d.reported(name + "_y"), d.reported(name + "_z")};
}

/// A floor that starts with the acceleration a takes a block along, with min(a, mu g).
TEST(MovingObstacle, FloorThatStartsCarriesABlockAlong) {
  constexpr double mu = 0.3, speed = 2, end = 1.5;
  const Vec3<double> along{std::cos(0.6), std::sin(0.6), 0}, across{-along.y, along.x, 0};
  for (const double part : {0.5, 0.95, 1.05, 2.0}) {
    Standing block({1, 1, 0.2}, {}, mu, 1e9);
    const double acceleration = part * mu * g, taken = std::min(part, 1.0) * mu * g;
    ObstacleMotion& motion = block.floor();
    motion.velocity = speed * along;
    motion.ramp.seconds = speed / acceleration;
    test::Dynamics d(block.scene, block.lattice);
    start(d);
    const double before = kept_and_lost(d);
    run_to(d, end);
    const double way = speed * d.state().time - 0.5 * speed * speed / taken;
    const double slip = 0.5 * speed * speed * (1 / taken - 1 / acceleration);
    const double heat = mu * block.mass * g * slip, kinetic = 0.5 * block.mass * speed * speed;
    test::verify({"Moving obstacles", test::text("block on a floor that starts with %g mu g", part),
                  dot(displacement(d.state(), 0), along), way, 3e-4 * way, "m",
                  "way: sticks up to mu g, slides above"});
    EXPECT_NEAR(dot(displacement(d.state(), 0), across), 0, 1e-9);
    EXPECT_NEAR(dot(velocity(d, 0), along), speed, 5e-3 * speed);
    EXPECT_NEAR(d.reported("energy_friction"), heat, 2e-3 * kinetic) << part;
    EXPECT_NEAR(d.reported("energy_external"), heat + kinetic, 2e-3 * kinetic) << part;
    EXPECT_NEAR(kept_and_lost(d) - before, d.reported("energy_external"), 1e-6 * kinetic);
  }
}

/// A block on a turntable goes round with it as long as w^2 r < mu g.
TEST(MovingObstacle, TurntableTakesABlockRound) {
  constexpr double radius = 1.5, mu = 0.3, ramp = 1, end = 4;
  const Vec3<double> foot{1, -2, -1}, top{1, -2, 0};
  for (const double omega : {-0.8, 0.8, 1.6}) {
    constexpr double side = 1;
    Standing block({side, side, 0.02}, top + Vec3<double>{radius, 0, 0}, mu, 1e7);
    ObstacleMotion& motion = append_obstacle(block.scene, "table", cone(foot, 3, 3, 1, 24)).motion;
    motion.angular_velocity = {0, 0, omega};
    motion.ramp.seconds = ramp;
    test::Dynamics d(block.scene, block.lattice);
    start(d, 0.25);
    const double before = kept_and_lost(d);
    run_to(d, end);
    const Vec3<double> at = displacement(d.state(), 0) + Vec3<double>{radius, 0, 0};
    if (omega > 1.5) {
      EXPECT_GT(std::hypot(at.x, at.y), radius + 0.1);
      continue;
    }
    const double turned = omega * (d.state().time - 0.5 * ramp);
    EXPECT_NEAR(at.x, radius * std::cos(turned), 1e-3 * radius);
    EXPECT_NEAR(at.y, radius * std::sin(turned), 1e-3 * radius);
    const double kinetic = 0.5 * block.mass * (radius * radius + side * side / 6) * omega * omega;
    EXPECT_NEAR(d.reported("energy_external"), kinetic, 0.01 * kinetic);
    EXPECT_NEAR(kept_and_lost(d) - before, d.reported("energy_external"), 1e-4 * kinetic);
  }
}

/// A paddle that turns about an oblique axis and hits a cube that floats in space. (A cube: the
/// kinetic energy of a turning body with three different moments of inertia errs with the step.)
struct Paddle {
  Scene scene;
  Lattice lattice;
  Vec3<double> centre{0.5, -1, 0.3}, spin{0.5, -0.4, 1.6};
  Paddle(double friction, double restitution)
      : scene(contact_scene(1e7, friction, restitution, false)) {
    scene.contact.law = ContactLaw::potential;
    append_obstacle(scene, "paddle", box(centre, {5, 0.4, 2}, {0, 0, 0})).motion.angular_velocity =
        spin;
    test::append_block(lattice, {0.8, 0.8, 0.8}, centre + Vec3<double>{1.6, 0.9, 0.1},
                       exp_rotation({0.3, 0.2, 0.5}), {0.1, -0.2, 0}, {0.2, 0.1, -0.3});
  }
};

/// In the frame that turns with the paddle a force without losses has a potential: what the block
/// gains is w.L (Jacobi's integral).
TEST(MovingObstacle, PaddleGivesEnergyByItsMoment) {
  double lost = 0;
  for (const double part : {0.2, 0.1}) {
    Paddle paddle(0, 1);
    test::Dynamics d(paddle.scene, paddle.lattice);
    start(d, part);
    const double before = d.kinetic();
    const auto about_axis = [&] {
      const auto p = d.momentum();  // about the origin
      const Vec3<double> linear{p[0], p[1], p[2]}, angular{p[3], p[4], p[5]};
      return dot(paddle.spin, angular - cross(paddle.centre, linear));
    };
    const double angular_before = about_axis();
    run_to(d, 1);
    const double given = d.reported("energy_external");
    EXPECT_EQ(d.reported("contacts"), 0);
    EXPECT_GT(given, 500);
    EXPECT_NEAR(about_axis() - angular_before, given, 1e-9 * given);
    EXPECT_NEAR(kept_and_lost(d) - before, given, 1e-12 * given);
    const double error = std::abs(d.kinetic() - before - given) / given;
    EXPECT_LT(error, part > 0.15 ? 1e-6 : 0.3 * lost);  // second order
    lost = error;
  }
}

/// All parts of a motion at once, with losses: the work is that of the reported wrench, whose
/// moment is about the frame's origin where that is.
TEST(MovingObstacle, LedgerClosesForEveryMotion) {
  Paddle paddle(0.3, 0.5);
  const ObstacleMotion motion{.velocity = {0.3, 0.4, -0.1},
                              .angular_velocity = paddle.spin,
                              .amplitude = {0.02, 0.05, 0.03},
                              .frequency = 4,
                              .ramp = {0.2}};
  paddle.scene.obstacles[0].motion = motion;
  test::Dynamics d(paddle.scene, paddle.lattice);
  // The sum below errs by the jump of the dashpot at the touch times the step: 1.04e-4 at a tenth.
  const double dt = start(d, 0.05), before = d.kinetic();
  double work = 0, twist = 0;
  while (d.state().time < 1) {
    const double t = d.state().time;
    const Vec3<double> force = reported(d, "paddle_force"), moment = reported(d, "paddle_moment");
    work -= dt * (dot(force, motion.rate(t)) + dot(moment, motion.spin(t)));
    twist += dt * std::sqrt(dot(moment, moment));
    (void)d.step();
  }
  EXPECT_EQ(d.reported("contacts"), 0);
  EXPECT_GT(twist, 100);
  EXPECT_GT(d.reported("energy_friction"), 1);
  EXPECT_GT(d.reported("energy_contact_viscous"), 10);
  const double given = d.reported("energy_external");
  EXPECT_NEAR(work, given, 1e-4 * given);
  EXPECT_NEAR(kept_and_lost(d) - before, given, 1e-12 * given);
}

/// A plate that swings to a distant block throws it off with twice its speed there; so does an arm
/// that turns a long way. Neither block is in the list at first.
TEST(MovingObstacle, ReachesWhatWasFar) {
  Scene scene = contact_scene(1e9, 0, 1, false);
  ObstacleMotion& swing =
      append_obstacle(scene, "plate", box({0, 0, 0}, {1, 3, 3}, {0, 0, 0})).motion;
  swing.amplitude = {2, 0, 0};
  swing.frequency = 0.2;
  Lattice lattice;
  test::append_block(lattice, {1, 1, 1}, {1 + 1.6, 0, 0});
  test::Dynamics d(scene, lattice);
  start(d);
  run_to(d, 1.2);
  const double speed = 2 * pi * 0.2 * std::sqrt(4 - 1.6 * 1.6);
  EXPECT_NEAR(velocity(d, 0).x, 2 * speed, 0.01 * speed);

  Scene turning = contact_scene(1e9, 0, 1, false);
  append_obstacle(turning, "arm", box({0, 0, 0}, {12, 0.5, 3}, {0, 0, 0}))
      .motion.angular_velocity = {0, 0, 1};
  Lattice ahead;  // its face lies on the arm's when that has turned by 2 rad
  const Vec3<double> radial{std::cos(2.0), std::sin(2.0), 0}, normal{-radial.y, radial.x, 0};
  test::append_block(ahead, {0.2, 0.2, 0.2}, 5 * radial + 0.35 * normal, exp_rotation({0, 0, 2}));
  test::Dynamics e(turning, ahead);
  start(e);
  run_to(e, 1.99);
  EXPECT_EQ(e.kinetic(), 0);
  run_to(e, 2.2);
  EXPECT_NEAR(dot(velocity(e, 0), normal), 2 * 5, 0.02 * 10);
}

/// Force of a floor on a block once it vibrates upwards and down, in weights, and where in the
/// period it is least.
struct Shaken {
  double least, most, phase;
};
Shaken shaken(double part) {
  constexpr double frequency = 5;
  Standing block({1, 1, 0.4}, {}, 0.3, 4e7);
  ObstacleMotion& motion = block.floor();
  motion.amplitude = {0, 0, part * g / std::pow(2 * pi * frequency, 2)};
  motion.frequency = frequency;
  motion.ramp.seconds = 1;
  test::Dynamics d(block.scene, block.lattice);
  start(d);
  run_to(d, 1.2);
  Shaken s{1e9, 0, 0};
  while (d.state().time < 2) {
    const double pressing = -d.reported("floor_force_z") / (block.mass * g);
    if (pressing < s.least) s.phase = std::remainder(frequency * d.state().time, 1.0);
    s.least = std::min(s.least, pressing);
    s.most = std::max(s.most, pressing);
    (void)d.step();
  }
  return s;
}

/// A block stays on a plate that vibrates upwards and down if and only if a (2 pi f)^2 < g.
TEST(MovingObstacle, VibratingPlateKeepsABlockBelowG) {
  const Shaken below = shaken(0.95), above = shaken(1.05);
  test::verify({"Moving obstacles", "block on a plate that vibrates with 0.95 g: least force",
                below.least, 0.05, 0.01, "weights", "1 - a w^2/g"});
  EXPECT_NEAR(below.most, 1.95, 0.02);
  EXPECT_NEAR(below.phase, 0.25, 0.02);  // where the plate is highest
  EXPECT_EQ(above.least, 0);
}

/// On a floor that shakes it sideways a block sticks below a w^2 = mu g. Far above it slides all
/// the time: its speed is a triangular wave of slope mu g in step with the floor's, highest pi mu
/// g/(2 w), where both are equal.
TEST(MovingObstacle, ShakenFloorDragsABlock) {
  constexpr double mu = 0.3, frequency = 2, omega = 2 * pi * frequency;
  for (const double part : {0.9, 4.0}) {
    const double amplitude = part * mu * g / (omega * omega);
    Standing block({1, 1, 0.2}, {}, mu, 1e7);
    ObstacleMotion& motion = block.floor();
    motion.amplitude = {0, amplitude, 0};
    motion.frequency = frequency;
    motion.ramp.seconds = 2;
    test::Dynamics d(block.scene, block.lattice);
    const double dt = start(d, 0.25);
    run_to(d, 4);
    const double heat = d.reported("energy_friction"), given = d.reported("energy_external");
    double fastest = 0, slip = 0, apart = 0;
    const double middle = displacement(d.state(), 0).y;
    while (d.state().time < 5) {
      (void)d.step();
      const double v = velocity(d, 0).y, t = d.state().time;
      fastest = std::max(fastest, std::abs(v));
      slip += dt * std::abs(v - motion.rate(t - 0.5 * dt).y);
      apart = std::max(apart, std::abs(displacement(d.state(), 0).y - middle - motion.way(t).y));
    }
    if (part < 1) {
      EXPECT_LT(apart, 2e-4);
      EXPECT_NEAR(fastest, amplitude * omega, 0.02 * amplitude * omega);
    } else {
      test::verify({"Moving obstacles", "block that slides on a shaken floor: largest speed",
                    fastest, pi * mu * g / (2 * omega), 0.01 * pi * mu * g / (2 * omega), "m/s",
                    "pi mu g/(2 w)"});
      // As after two periods before: all that is given is heat.
      const double lost = d.reported("energy_friction") - heat;
      EXPECT_NEAR(lost, mu * block.mass * g * slip, 0.005 * lost);
      EXPECT_NEAR(d.reported("energy_external") - given, lost, 0.005 * lost);
    }
  }
}

}  // namespace
}  // namespace floe
