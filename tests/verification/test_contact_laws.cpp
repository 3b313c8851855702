// Both contact laws on what they must do (docs/decisions/51-contact-law.md): stack, wall, incline,
// rest, piles, gain of undamped bodies. The short form runs what takes seconds.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "support/contact_scene.h"
#include "support/record.h"

namespace floe {
namespace {

using test::append_block;
using test::append_obstacle;
using test::contact_scene;

constexpr double g = 9.81;
constexpr std::array laws{ContactLaw::overlap, ContactLaw::potential};

std::string name_of(ContactLaw law) { return law == ContactLaw::overlap ? "overlap" : "potential"; }

/// Sets a part of the step that `dt: auto` takes.
double start_resolved(test::Dynamics& d, double part = 1) {
  double dt = 0.9 * stable_step(d.model(), d.state()).dt;
  for (const auto& force : d.model().forces()) {
    if (const auto* role = force->roles().step) dt = std::min(dt, role->resolved_step());
  }
  d.evaluate();
  d.set_step(part * dt);
  return part * dt;
}

/// 216 elastic cubes that fly about in a box: some thousand impacts.
struct Gas {
  Lattice lattice;
  Scene scene = contact_scene(1e7, 0, 1, false);
  explicit Gas(ContactLaw law, std::uint64_t seed = 3) {
    constexpr int across = 6;
    constexpr double apart = 1.8, wall = 0.5 * apart * across;
    scene.contact.law = law;
    for (const double side : {1.0, -1.0}) {
      for (int k = 0; k < 3; ++k) {
        Vec3<double> normal{};
        normal[static_cast<std::size_t>(k)] = side;
        append_obstacle(scene, "wall" + std::to_string(k) + (side > 0 ? "_low" : "_high"),
                        half_space((-wall) * normal, normal));
      }
    }
    test::Random random(seed);
    for (int k = 0; k < across * across * across; ++k) {
      const auto at = [&](int i) { return apart * (i - 0.5 * (across - 1)); };
      append_block(lattice, {1, 1, 1},
                   {at(k % across), at(k / across % across), at(k / across / across)},
                   random.rotation(random.uniform(0, 3)), random.vector(1), random.vector(1));
    }
  }
  /// Returns the gain of energy over a time, in parts of it, at a part of the step of dt: auto.
  double gain(double part, double seconds) const {
    test::Dynamics d(scene, lattice);
    (void)start_resolved(d, part);
    const double before = d.kinetic();
    double touches = 0, contacts = 0;
    while (d.state().time < seconds) {
      (void)d.step();
      const double now = d.reported("contacts");
      touches += std::max(now - contacts, 0.0);
      contacts = now;
    }
    impacts = touches;
    return (d.kinetic() + d.reported("energy_contact")) / before - 1;
  }
  mutable double impacts = 0;  ///< of the last gain(), at least
};

/// The step of `dt: auto` has 11 steps in half a period of a touch by the largest face. `potential`
/// gains what the step does, in second order; `overlap` gains at any step.
TEST(ContactLaws, GainOfUndampedBodies) {
  for (const ContactLaw law : laws) {
    const Gas gas(law);
    std::vector<double> gains;
    for (const double part : {1.0, 0.5, 0.25}) {
      if (part < 1 && !test::full_form()) continue;
      gains.push_back(gas.gain(part, 10));
      std::printf("%s, %.2f of dt auto: gain %.3e in %.0f impacts\n", name_of(law).c_str(), part,
                  gains.back(), gas.impacts);
      test::report({"contact laws",
                    "gain of 216 cubes in 10 s, " + name_of(law) + ", part of dt auto " +
                        test::text("%.2f", part),
                    gains.back()});
    }
    if (law == ContactLaw::potential) {
      EXPECT_LT(std::abs(gains[0]), 1e-3);
    } else {
      EXPECT_LT(std::abs(gains[0]), 0.1);
    }
  }
}

/// Over several seeds at the step of dt: auto.
TEST(ContactLaws, GainOverSeeds) {
  if (!test::full_form()) GTEST_SKIP() << "in the full form only (FLOE_FULL=1)";
  constexpr int seeds = 8;
  for (const ContactLaw law : laws) {
    double mean = 0, squares = 0, most = 0;
    for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
      const double gain = Gas(law, seed).gain(1, 10);
      mean += gain / seeds;
      squares += gain * gain / seeds;
      most = std::max(most, std::abs(gain));
    }
    std::printf("%s: mean gain %.2e, rms %.2e, largest %.2e\n", name_of(law).c_str(), mean,
                std::sqrt(squares), most);
    test::report({"contact laws",
                  "mean gain of 216 cubes in 10 s over 8 seeds, " + name_of(law),
                  mean,
                  {},
                  {},
                  "",
                  test::text("rms %.1e", std::sqrt(squares))});
    EXPECT_LT(most, law == ContactLaw::potential ? 1e-3 : 0.05);
  }
}

/// How far stacks of ten cubes of 1 m that are pushed a little lean after 60 s, and whether a cube
/// on a floor stands upright.
TEST(ContactLaws, StackOfTenThatIsPushed) {
  if (!test::full_form()) GTEST_SKIP() << "in the full form only (FLOE_FULL=1)";
  for (const ContactLaw law : laws) {
    for (const double young : {1e8, 4e9}) {
      Scene scene = contact_scene(young, 0.5, 0.45);
      scene.contact.law = law;
      append_obstacle(scene, "floor", half_space({0, 0, 0}, {0, 0, 1}));
      Lattice lattice;
      for (int k = 0; k < 10; ++k)
        append_block(lattice, {1, 1, 1}, {0, 0, 0.5 + k}, {1, 0, 0, 0}, {1e-4 * k, 0, 0});
      test::Dynamics d(scene, lattice);
      (void)start_resolved(d);
      double tilt = 0;
      for (const double end : {20.0, 60.0}) {
        while (d.state().time < end) (void)d.step();
        const double* top = d.state().record(9);
        tilt = 2 * std::hypot(d.state().record(0)[4], d.state().record(0)[5]);
        std::printf(
            "%s, E_c %.0e, %2.0f s: top %.2e m aside, lowest cube tilted by %.2e rad, "
            "kinetic %.1e J\n",
            name_of(law).c_str(), young, end, std::hypot(top[0], top[1]), tilt, d.kinetic());
      }
      test::report({"contact laws",
                    "stack of ten, E_c " + test::text("%.0e", young) +
                        ", tilt of the lowest cube, " + name_of(law),
                    tilt,
                    {},
                    {},
                    "rad"});
    }
  }
}

/// Five blocks on a plane of 0, 1 and 2 degrees: until when they have more than 1e-10 J, and how
/// far the uppermost has gone sideways by then.
TEST(ContactLaws, StackOfFive) {
  for (const ContactLaw law : laws) {
    for (const int degrees : {0, 1, 2}) {
      if (degrees == 1 && !test::full_form()) continue;
      Scene scene = contact_scene(4e9, 0.5, 0.45);
      scene.contact.law = law;
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
      const Vec3<double> u = displacement(d.state(), 4);
      const double aside = std::hypot(u.x * std::cos(angle) - u.z * std::sin(angle), u.y);
      const std::string of = name_of(law) + "_" + std::to_string(degrees);
      RecordProperty(of + "_time", test::text("%.1f", d.state().time));
      RecordProperty(of + "_energy", test::text("%.1e", energy));
      RecordProperty(of + "_aside", test::text("%.2e", aside));
      test::report(
          {"contact laws", "stack of five, kinetic energy at the end, " + of, energy, {}, {}, "J"});
      if (law == ContactLaw::overlap) {
        EXPECT_LT(energy, 1e-10) << degrees;
      }
    }
  }
}

/// A block sticks to an incline if tan(alpha) < mu, else it slides at g (sin - mu cos).
TEST(ContactLaws, Incline) {
  for (const ContactLaw law : laws) {
    for (const double share : {0.95, 1.3}) {
      constexpr double mu = 0.3;
      const double angle = std::atan(share * mu);
      Scene scene = contact_scene(1e8, mu, 0.45);
      scene.contact.law = law;
      const Vec3<double> normal{std::sin(angle), 0, std::cos(angle)};
      const Vec3<double> downhill{std::cos(angle), 0, -std::sin(angle)};
      append_obstacle(scene, "floor", half_space({0, 0, 0}, normal));
      Lattice lattice;
      append_block(lattice, {1, 1, 0.4}, 0.2 * normal, exp_rotation({0, angle, 0}));
      test::Dynamics d(scene, lattice);
      const double dt = start_resolved(d);
      d.steps(static_cast<long>(1 / dt));
      const double early = dot(test::velocity(d, 0), downhill), at = d.state().time;
      d.steps(static_cast<long>(1 / dt));
      const double rate = (dot(test::velocity(d, 0), downhill) - early) / (d.state().time - at);
      const double expected = share > 1 ? g * (std::sin(angle) - mu * std::cos(angle)) : 0.0;
      EXPECT_NEAR(rate, expected, 0.01 * g * mu) << name_of(law) << " " << share;
      RecordProperty(name_of(law) + test::text("_%.2f", share), test::text("%.4f", rate));
    }
  }
}

/// Cubes in random attitudes above a floor.
struct Cubes {
  Scene scene;
  Lattice lattice;
  double edge;
  Cubes(ContactLaw law, int across, int high, double size, double friction, double young)
      : scene(contact_scene(young, friction, 0.45)), edge(size) {
    scene.contact.law = law;
    append_obstacle(scene, "floor", half_space({0, 0, 0}, {0, 0, 1}));
    test::Random random(5);
    for (int k = 0; k < across * across * high; ++k) {
      const Vec3<double> at{1.75 * (k % across - 0.5 * (across - 1)),
                            1.75 * (k / across % across - 0.5 * (across - 1)),
                            0.9 + 1.75 * (k / across / across)};
      append_block(lattice, {size, size, size}, size * at, random.rotation(random.uniform(0, 3)));
    }
  }
};

/// A pile of 27 cubes of 1 m comes to rest: when its kinetic energy is below 1e-6 of what it fell.
TEST(ContactLaws, PileOfCubesComesToRest) {
  for (const ContactLaw law : laws) {
    const Cubes cubes(law, 3, 3, 1, 0.5, 1e8);
    test::Dynamics d(cubes.scene, cubes.lattice);
    const double dt = start_resolved(d);
    double rest = 0, share = 1;
    while (d.state().time < 30) {
      d.steps(static_cast<long>(0.25 / dt));
      double fallen = 0;
      for (std::size_t b = 0; b < cubes.lattice.bodies.mass.size(); ++b)
        fallen -= 920 * g * displacement(d.state(), b).z;
      share = d.kinetic() / fallen;
      if (share > 1e-6) {
        rest = 0;
      } else if (rest == 0) {
        rest = d.state().time;
      }
      if (rest > 0 && !test::full_form() && d.state().time > rest + 1) break;
    }
    EXPECT_GT(rest, 0) << name_of(law) << " " << share;
    RecordProperty(name_of(law) + "_rest", test::text("%.2f", rest));
    RecordProperty(name_of(law) + "_share", test::text("%.1e", share));
    test::report({"contact laws",
                  "a pile of 27 cubes has 1e-6 of what it fell, " + name_of(law),
                  rest,
                  {},
                  {},
                  "s"});
  }
}

/// Slope of the cone of equal centroid height and mean distance from its axis (H/4, R/2) into which
/// 216 cubes collapse on a rough floor, against mu.
TEST(ContactLaws, AngleOfRepose) {
  if (!test::full_form()) GTEST_SKIP() << "in the full form only (FLOE_FULL=1)";
  for (const ContactLaw law : laws) {
    double last = 0;
    for (const double mu : {0.05, 0.2, 0.4, 0.8}) {
      Cubes cubes(law, 5, 8, 0.5, mu, 2e7);
      cubes.scene.obstacles[0].friction = 1;
      test::Dynamics d(cubes.scene, cubes.lattice);
      const double dt = start_resolved(d);
      d.steps(static_cast<long>(8 / dt));
      const std::size_t n = cubes.lattice.bodies.mass.size();
      double height = 0, distance = 0;
      for (std::size_t b = 0; b < n; ++b) {
        const Vec3<double> x = cubes.lattice.bodies.position[b] + displacement(d.state(), b);
        height += x.z / static_cast<double>(n);
        distance += std::hypot(x.x, x.y) / static_cast<double>(n);
      }
      const double angle = std::atan(2 * height / distance) * 180 / std::numbers::pi;
      std::printf("%s mu %.2f: %.1f degrees, kinetic %.1e J\n", name_of(law).c_str(), mu, angle,
                  d.kinetic());
      test::report({"contact laws",
                    "slope of a heap of cubes, " + name_of(law) + ", mu " + test::text("%.2f", mu),
                    angle,
                    {},
                    {},
                    "degrees"});
      EXPECT_GT(angle, last) << mu;
      last = angle;
    }
  }
}

}  // namespace
}  // namespace floe
