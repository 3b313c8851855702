// What acts over the area of a contact, and in time (model.md, "Contact"): restitution, the impulse
// of friction, spin, rest.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "contact_laws/friction.h"
#include "contact_laws/restitution.h"
#include "support/contact_scene.h"
#include "support/record.h"

namespace floe {
namespace {

using test::append_block;
using test::append_obstacle;
using test::velocity;

constexpr double g = 9.81;

Vec3<double> spin(test::Dynamics& d, std::size_t body) {
  const double* r = d.state().record(body);
  return {r[10], r[11], r[12]};
}

/// The longest step that a force resolves, as `dt: auto` asks for it.
double resolved_step(test::Dynamics& d) {
  double dt = std::numeric_limits<double>::infinity();
  for (const auto& force : d.model().forces()) {
    if (const auto* role = force->roles().step) dt = std::min(dt, role->resolved_step());
  }
  return dt;
}

/// Sets the step that `dt: auto` takes.
double start_resolved(test::Dynamics& d) {
  const double dt = std::min(0.9 * stable_step(d.model(), d.state()).dt, resolved_step(d));
  d.evaluate();
  d.set_step(dt);
  return dt;
}

/// An impact of a block on a plane without gravity, at the step of dt: auto.
struct Impact {
  ContactLaw law = ContactLaw::potential;
  double restitution = 0.451, friction = 0;
  Vec3<double> size{1, 1, 1};
  Quat<double> attitude{1, 0, 0, 0};
  double reach = 0.5;  ///< of the block below its centroid [m]
  double speed = 1, sliding = 0;
  double phase = 0;  ///< part of a step by which it comes later

  /// Returns the velocity after it, over the speed.
  Vec3<double> returned() const {
    Scene scene = test::contact_scene(1e7, friction, restitution, false);
    scene.contact.law = law;
    append_obstacle(scene, "floor", half_space({0, 0, 0}, {0, 0, 1}));
    double gap = 1e-3 * speed;
    for (int pass = 0;; ++pass) {
      Lattice lattice;
      append_block(lattice, size, {0, 0, reach + gap}, attitude, {sliding, 0, -speed});
      test::Dynamics d(scene, lattice);
      const double dt = start_resolved(d);
      if (pass == 0) {
        gap = (5 + phase) * dt * speed;
        continue;
      }
      while (d.reported("contacts") == 0) d.steps(1);
      while (d.reported("contacts") > 0) d.steps(1);
      return (1 / speed) * velocity(d, 0);
    }
  }
  /// Returns the largest error of e over the phases of the first touch, in parts of e.
  double worst_error() {
    double worst = 0;
    for (int k = 0; k < 10; ++k) {
      phase = 0.1 * k + 0.013;
      worst = std::max(worst, std::abs(returned().z / restitution - 1));
    }
    return worst;
  }
};

const Quat<double> on_edge = exp_rotation({0, 0.25 * std::numbers::pi, 0});
const Quat<double> on_corner = product(exp_rotation({std::atan(std::sqrt(0.5)), 0, 0}), on_edge);

TEST(ContactArea, RestitutionIsAsGivenForFacesEdgesAndCornersAtAnySpeed) {
  for (const double e : {0.5, 0.3}) {
    for (const double speed : {0.01, 0.1, 1.0}) {
      Impact face{.restitution = e, .speed = speed};
      EXPECT_LT(face.worst_error(), 0.02) << "face " << e << " " << speed;
      Impact edge{.restitution = e, .attitude = on_edge, .reach = std::sqrt(0.5), .speed = speed};
      EXPECT_LT(edge.worst_error(), 0.02) << "edge " << e << " " << speed;
      Impact corner{
          .restitution = e, .attitude = on_corner, .reach = std::sqrt(0.75), .speed = speed};
      EXPECT_LT(corner.worst_error(), 0.02) << "corner " << e << " " << speed;
    }
  }
}

TEST(ContactArea, RestitutionOfPlatesDoesNotDependOnTheirThickness) {
  for (const double e : {0.5, 0.3}) {
    for (const double thickness : {0.1, 0.2, 0.5, 1.0, 2.0}) {
      Impact plate{.restitution = e, .size = {1, 1, thickness}, .reach = 0.5 * thickness};
      plate.speed = 0.1 * thickness;
      EXPECT_LT(plate.worst_error(), 0.02) << thickness << " potential " << e;
      plate.law = ContactLaw::overlap;
      EXPECT_LT(plate.worst_error(), 0.02) << thickness << " overlap " << e;
    }
  }
}

/// 11 steps in half a period of a block on its largest face, 14 for e < 0.4; the law `potential` is
/// stiffer by A/A_r.
TEST(ContactArea, AutomaticStepResolvesATouch) {
  for (const ContactLaw law : {ContactLaw::overlap, ContactLaw::potential}) {
    for (const double e : {1.0, 0.5, 0.3}) {
      Scene scene = test::contact_scene(1e7, 0, e);
      scene.contact.law = law;
      append_obstacle(scene, "floor", half_space({0, 0, 0}, {0, 0, 1}));
      Lattice lattice;
      append_block(lattice, {2, 3, 0.5}, {0, 0, 1});
      test::Dynamics d(scene, lattice);
      const double size = std::cbrt(3), area = law == ContactLaw::overlap ? 6 : 36 / (size * size);
      const double omega = std::sqrt(1e7 / (0.5 * size) * area / (920 * 3));
      EXPECT_NEAR(resolved_step(d) * omega / std::numbers::pi, 1 / (e < 0.4 ? 14.0 : 11.0), 1e-12);
    }
  }
}

/// A face that slides all through an impact takes mu times the impulse along the normal. Its
/// rotation is held by a large moment of inertia: the block is a wide plate.
TEST(ContactArea, SlidingFrictionHasItsImpulse) {
  for (const double mu : {0.1, 0.3}) {
    for (const double e : {1.0, 0.5}) {
      for (int k = 0; k < 5; ++k) {
        Impact impact{.restitution = e, .friction = mu, .size = {4, 4, 0.05}, .reach = 0.025};
        impact.speed = 0.01;
        impact.sliding = 3 * mu * impact.speed;
        impact.phase = 0.2 * k + 0.013;
        const Vec3<double> v = impact.returned();
        const double impulse = (3 * mu - v.x) / (mu * (1 + v.z));
        EXPECT_NEAR(impulse, 1, 0.03) << mu << " " << e << " " << k;
      }
    }
  }
}

Scene floor_scene(double friction, double restitution = 0.451) {
  Scene scene = test::contact_scene(1e8, friction, restitution);
  append_obstacle(scene, "floor", half_space({0, 0, 0}, {0, 0, 1}));
  return scene;
}

/// Depth at which a block rests on the floor [m].
double sunk(const Scene& scene, const Vec3<double>& size, double volume) {
  const double area = volume / size.z;
  return 920 * volume * g * 0.5 * std::cbrt(volume) / (scene.contact.young * area);
}

/// Time at which the spin about z has ended [s].
double stops_at(test::Dynamics& d) {
  (void)start_resolved(d);
  const double first = spin(d, 0).z;
  while (spin(d, 0).z > 1e-3 * first) (void)d.step();
  return d.state().time;
}

/// Coulomb's couple mu m g 0.3826 a against I = m a^2/6.
TEST(ContactArea, CubeStopsSpinning) {
  Scene scene = floor_scene(0.5);
  Lattice lattice;
  constexpr double a = 0.5;
  append_block(lattice, {a, a, a}, {0, 0, 0.5 * a - sunk(scene, {a, a, a}, a * a * a)},
               {1, 0, 0, 0}, {}, {0, 0, 5});
  test::Dynamics d(scene, lattice);
  const double reach = (std::sqrt(2) + std::asinh(1)) / 6;
  const double expected = 5 * a / (6 * reach * 0.5 * g);
  const double time = stops_at(d);
  EXPECT_NEAR(time, expected, 0.02 * expected);
  EXPECT_NEAR(time, 0.22, 0.005);
  const double spinning = 0.5 * 920 * std::pow(a, 5) / 6 * 25;  // [J]
  // What it had is lost to friction, and it stays.
  EXPECT_NEAR(d.reported("energy_friction"), spinning, 0.02 * spinning);
  d.steps(1000);
  EXPECT_LT(std::abs(spin(d, 0).z), 5e-3);
}

/// A disc: mu m g 2R/3 against m R^2/2.
TEST(ContactArea, DiscStopsSpinning) {
  constexpr int sides = 48;
  constexpr double r = 0.6, h = 0.3;
  Scene scene = floor_scene(0.2);
  Lattice lattice;
  std::vector<Point2> polygon;
  for (int k = 0; k < sides; ++k) {
    const double angle = 2 * std::numbers::pi * k / sides;
    polygon.push_back({r * std::cos(angle), r * std::sin(angle)});
  }
  append_prism(lattice.shapes, polygon, -0.5 * h, 0.5 * h);
  const VolumeProperties p = volume_properties(lattice.shapes, 0);
  test::append_block_body(
      lattice, {0, 0, 0.5 * h - sunk(scene, {0, 0, h}, p.volume)}, {1, 0, 0, 0}, 920 * p.volume,
      {920 * p.inertia[0], 920 * p.inertia[4], 920 * p.inertia[8]}, {}, {0, 0, 4});
  test::Dynamics d(scene, lattice);
  const double expected = 0.5 * r * r * 4 / (2.0 / 3 * r * 0.2 * g);
  EXPECT_NEAR(stops_at(d), expected, 0.02 * expected);
}

/// A block in the middle of a turntable turns with it; the friction that turns it is mu m g r_eff.
TEST(ContactArea, BlockTurnsWithATurntable) {
  Scene scene = test::contact_scene(1e8, 0.3, 0.451);
  scene.obstacles.push_back(box({0, 0, -0.5}, {6, 6, 1}, {0, 0, 0}));
  scene.obstacles.back().name = "table";
  scene.obstacles.back().friction = 0.3;
  scene.obstacles.back().motion.angular_velocity = {0, 0, 1};
  Lattice lattice;
  append_block(lattice, {1, 1, 0.5}, {0, 0, 0.25 - sunk(scene, {1, 1, 0.5}, 0.5)});
  test::Dynamics d(scene, lattice);
  (void)start_resolved(d);
  const double reach = (std::sqrt(2) + std::asinh(1)) / 6;
  const double rate = 6 * reach * 0.3 * g;  // rad/s^2
  while (d.state().time < 0.5 / rate) (void)d.step();
  EXPECT_NEAR(spin(d, 0).z, 0.5, 0.02);
  while (d.state().time < 3) (void)d.step();
  EXPECT_NEAR(spin(d, 0).z, 1, 1e-4);
}

/// Coulomb's limit on slip and spin together lies on an ellipse.
TEST(ContactArea, SlipAndSpinShareTheLimit) {
  const Friction over{.force = {30, 40, 0}, .couple = 30}, under{.force = {3, 4, 0}, .couple = 3};
  const Friction both = within(over, 10.0, 2.0);
  EXPECT_NEAR(std::pow(length(both.force) / 10, 2) + std::pow(both.couple / 20, 2), 1, 1e-12);
  EXPECT_NEAR(both.couple / both.force.x, 1, 1e-12);
  EXPECT_EQ(within(under, 10.0, 2.0).couple, 3);
  EXPECT_EQ(within(under, 0.0, 2.0).force.x, 0);
}

/// Five blocks on a slope of 0, 1 and 2 degrees that are let go come to rest.
TEST(ContactArea, StackOfFiveComesToRest) {
  for (const int degrees : {0, 1, 2}) {
    Scene scene = test::contact_scene(4e9, 0.5, 0.45);
    const double angle = degrees * std::numbers::pi / 180;
    const Vec3<double> normal{std::sin(angle), 0, std::cos(angle)};
    append_obstacle(scene, "floor", half_space({0, 0, 0}, normal));
    Lattice lattice;
    for (int k = 0; k < 5; ++k)
      append_block(lattice, {1, 1, 1}, (0.5 + k) * normal, exp_rotation({0, angle, 0}));
    test::Dynamics d(scene, lattice);
    const double dt = start_resolved(d);
    double energy = 1;
    while (d.state().time < 60 && !(energy < 1e-10)) {
      d.steps(static_cast<long>(0.5 / dt));
      energy = d.kinetic();
    }
    EXPECT_LT(energy, 1e-10) << degrees;
    RecordProperty("time_" + std::to_string(degrees), std::to_string(d.state().time));
  }
}

/// A wall of bricks that is set down comes to rest where it stands, with both laws.
TEST(ContactArea, WallComesToRest) {
  for (const ContactLaw law : {ContactLaw::overlap, ContactLaw::potential}) {
    Scene scene = test::contact_scene(4e9, 0.4, 0.45);
    scene.contact.law = law;
    append_obstacle(scene, "floor", half_space({0, 0, 0}, {0, 0, 1}));
    Lattice lattice;
    for (int row = 0; row < 4; ++row) {
      for (int k = 0; k < 4 - row % 2; ++k)
        append_block(lattice, {1, 0.5, 0.4}, {1.001 * k + 0.5005 * (row % 2), 0, 0.2 + 0.4 * row});
    }
    test::Dynamics d(scene, lattice);
    const double dt = start_resolved(d);
    while (d.state().time < 10 && !(d.state().time > 0 && d.kinetic() < 1e-10))
      d.steps(static_cast<long>(0.5 / dt));
    EXPECT_LT(d.kinetic(), 1e-10);
    for (std::size_t b = 0; b < lattice.bodies.mass.size(); ++b) {
      const Vec3<double> u = displacement(d.state(), b);
      EXPECT_LT(std::hypot(u.x, u.y), 1e-4) << b;
    }
  }
}

/// A column of 20 blocks of 1 m that sways on its contacts loses energy at 5.6e-3 1/s by the
/// eigenvalues of its linear model (0.81 Hz; zeta = 0.3, E_c = 4 GPa).
TEST(ContactArea, SwayOfTwentyDecaysAsItsEigenvalue) {
  Scene scene = test::contact_scene(4e9, 0.5, 0.451);
  append_obstacle(scene, "floor", half_space({0, 0, 0}, {0, 0, 1}));
  Lattice lattice;
  double sunk_so_far = 0;
  for (int k = 0; k < 20; ++k) {
    sunk_so_far += (20 - k) * 920 * g / (k == 0 ? 8e9 : 4e9);
    const double share = (k + 0.5) / 20;
    append_block(lattice, {1, 1, 1}, {0, 0, 0.5 + k - sunk_so_far}, {1, 0, 0, 0},
                 {1e-3 * share * share, 0, 0});
  }
  test::Dynamics d(scene, lattice);
  (void)start_resolved(d);
  const auto largest_until = [&](double time) {
    double most = 0;
    while (d.state().time < time) {
      d.steps(20);
      most = std::max(most, d.kinetic());
    }
    return most;
  };
  (void)largest_until(1.25);
  const double early = largest_until(2.5);
  (void)largest_until(13.75);
  const double late = largest_until(15);
  EXPECT_NEAR(std::log(early / late) / 12.5, 5.6e-3, 0.56e-3);
}

}  // namespace
}  // namespace floe
