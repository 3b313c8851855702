// Contact of bodies against analytic results (model.md, "Contact").

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "contact_laws/laws.h"
#include "contact_laws/restitution.h"
#include "files/hdf5.h"
#include "lattice/archive.h"
#include "support/contact_scene.h"
#include "support/record.h"
#include "support/roles.h"

namespace floe {
namespace {

using test::append_obstacle;
using test::start;
using test::velocity;

constexpr double g = 9.81, young = 1e7;

Scene contact_scene(double friction, double restitution, bool gravity = true) {
  return test::contact_scene(young, friction, restitution, gravity);
}

void add_plane(Scene& scene, const Vec3<double>& normal) {
  append_obstacle(scene, "floor", half_space({0, 0, 0}, normal));
}

/// A block on an incline whose downhill direction is (cos a, 0, -sin a), in static contact.
struct Incline {
  double angle;
  Vec3<double> size;
  Lattice lattice;
  Scene scene;
  Incline(double tangent, double friction, const Vec3<double>& s)
      : angle(std::atan(tangent)), size(s), scene(contact_scene(friction, 0.3)) {
    const Vec3<double> normal{std::sin(angle), 0, std::cos(angle)};
    add_plane(scene, normal);
    const double mass = 920 * size.x * size.y * size.z;
    const double stiffness = young / (0.5 * std::cbrt(size.x * size.y * size.z));
    const double sunk = mass * g * std::cos(angle) / (stiffness * size.x * size.y);
    test::append_block(lattice, size, (0.5 * size.z - sunk) * normal, exp_rotation({0, angle, 0}));
  }
  Vec3<double> downhill() const { return {std::cos(angle), 0, -std::sin(angle)}; }
};

/// It is let go without friction in its springs, swings past their limit and slips a little; then
/// it rests.
TEST(Contact, BlockSticksBelowTheAngleOfFriction) {
  Incline incline(0.99 * 0.3, 0.3, {1, 1, 0.4});
  test::Dynamics d(incline.scene, incline.lattice);
  const double dt = start(d);
  d.steps(static_cast<long>(2 / dt));
  const double before = dot(displacement(d.state(), 0), incline.downhill());
  EXPECT_LT(std::abs(before), 0.01);
  d.steps(static_cast<long>(3 / dt));
  EXPECT_NEAR(dot(displacement(d.state(), 0), incline.downhill()), before, 1e-5);
}

TEST(Contact, BlockSlidesAboveTheAngleOfFriction) {
  for (const double over : {1.01, 1.2, 2.0}) {
    Incline incline(over * 0.3, 0.3, {1, 1, 0.4});
    test::Dynamics d(incline.scene, incline.lattice);
    const double dt = start(d);
    const long n = static_cast<long>(0.5 / dt);
    d.steps(n);
    const double before = dot(velocity(d, 0), incline.downhill());
    d.steps(2 * n);
    const double after = dot(velocity(d, 0), incline.downhill());
    const double expected = g * (std::sin(incline.angle) - 0.3 * std::cos(incline.angle));
    EXPECT_NEAR((after - before) / (2 * static_cast<double>(n) * dt), expected, 0.01 * expected)
        << over;
  }
}

TEST(Contact, SlenderBlockTopplesOnASteepIncline) {
  for (const double tangent : {0.30, 0.37}) {  // b/h = 1/3
    Incline incline(tangent, 0.8, {0.5, 0.5, 1.5});
    incline.scene.contact.young = 100 * young;  // its weight stands on a strip at the edge
    incline.scene.contact.damping_ratio = damping_ratio_of(0.01);  // it must not rock over the edge
    test::Dynamics d(incline.scene, incline.lattice);
    const double dt = start(d);
    d.steps(static_cast<long>(3 / dt));
    const double turned = std::abs(log_rotation(rotation(d.state(), 0)).y);
    if (tangent < 1.0 / 3) {
      EXPECT_LT(turned, 0.05);
    } else {
      EXPECT_GT(turned, 0.8);
    }
  }
}

TEST(Contact, StoppingDistance) {
  const double speed = 2, mu = 0.2;
  Incline flat(0, mu, {1, 1, 0.2});
  flat.lattice.bodies.velocity[0] = {speed, 0, 0};
  test::Dynamics d(flat.scene, flat.lattice);
  const double dt = start(d);
  d.steps(static_cast<long>(1.5 / dt));
  const double expected = speed * speed / (2 * mu * g);
  EXPECT_NEAR(displacement(d.state(), 0).x, expected, 0.01 * expected);
  EXPECT_LT(std::abs(velocity(d, 0).x), 1e-2);
  // What the block had is lost to friction.
  EXPECT_NEAR(d.reported("energy_friction"), 0.5 * 920 * 0.2 * speed * speed, 0.01 * 368);
}

TEST(Contact, StackOfTenStaysAndCarriesItsWeight) {
  Scene scene = contact_scene(0.3, 0.3);
  add_plane(scene, {0, 0, 1});
  // A column of n blocks on elastic joints buckles under its weight q n a from q (n a)^3 = 7.84
  // k_v a^5/12 on: E_c = 1.4e7 Pa here.
  constexpr double stiff = 1e8;
  scene.contact.young = stiff;
  Lattice lattice;
  constexpr int n = 10;
  for (int k = 0; k < n; ++k) test::append_block(lattice, {1, 1, 1}, {0, 0, 0.5 + k});
  test::Dynamics d(scene, lattice);
  const double dt = start(d, 0.9);
  d.steps(static_cast<long>(60 / dt));
  const double weight = 920 * g;
  for (int k = 0; k < n; ++k) {
    const auto b = static_cast<std::size_t>(k);
    const Vec3<double> u = displacement(d.state(), b);
    EXPECT_LT(std::hypot(u.x, u.y), 1e-3) << k;
    const double below = k == 0 ? 0.0 : displacement(d.state(), b - 1).z;
    const double stiffness = k == 0 ? stiff / 0.5 : stiff / 1.0;  // L = 0.5 m, of the floor 0
    EXPECT_NEAR((below - u.z) * stiffness, (n - k) * weight, 1e-3 * (n - k) * weight) << k;
  }
}

/// Returned part of the speed of a block that falls on a plane without gravity.
double returned(double restitution, double speed, const Quat<double>& q, double reach,
                ContactLaw law = ContactLaw::overlap) {
  Scene scene = contact_scene(0, restitution, false);
  scene.contact.law = law;
  add_plane(scene, {0, 0, 1});
  Lattice lattice;
  test::append_block(lattice, {1, 1, 1}, {0, 0, reach + 0.001}, q, {0, 0, -speed});
  test::Dynamics d(scene, lattice);
  start(d, 0.05);
  while (d.reported("contacts") == 0) d.steps(10);
  while (d.reported("contacts") > 0) d.steps(10);
  return velocity(d, 0).z / speed;
}

TEST(Contact, RestitutionOfFacesIsAsGiven) {
  for (const double e : {1.0, 0.744, 0.451, 0.298}) {
    EXPECT_NEAR(returned(e, 1, {1, 0, 0, 0}, 0.5), e, 0.02 * e) << e;
    EXPECT_NEAR(returned(e, 0.1, {1, 0, 0, 0}, 0.5), e, 0.02 * e) << e;
  }
  EXPECT_NEAR(damping_ratio_of(0.744), 0.1, 1e-3);
  EXPECT_NEAR(damping_ratio_of(0.451), 0.3, 1e-3);
}

TEST(Contact, RestitutionOfEdgesAndCornersDoesNotDependOnSpeed) {
  const Quat<double> edge = exp_rotation({0, 0.25 * std::numbers::pi, 0});
  const Quat<double> corner = product(exp_rotation({std::atan(std::sqrt(0.5)), 0, 0}),
                                      exp_rotation({0, 0.25 * std::numbers::pi, 0}));
  const double at_edge = returned(0.451, 1, edge, std::sqrt(0.5));
  EXPECT_NEAR(returned(0.451, 0.1, edge, std::sqrt(0.5)), at_edge, 0.02 * at_edge);
  const double at_corner = returned(0.451, 1, corner, std::sqrt(0.75));
  EXPECT_NEAR(returned(0.451, 0.1, corner, std::sqrt(0.75)), at_corner, 0.02 * at_corner);
  EXPECT_NEAR(at_edge, 0.407, 0.01);
  EXPECT_NEAR(at_corner, 0.389, 0.01);
  // Without damping a half-space gives back everything, with both laws.
  for (const ContactLaw law : {ContactLaw::overlap, ContactLaw::potential}) {
    EXPECT_NEAR(returned(1, 1, {1, 0, 0, 0}, 0.5, law), 1, 1e-3);
    EXPECT_NEAR(returned(1, 1, edge, std::sqrt(0.5), law), 1, 1e-3);
    EXPECT_NEAR(returned(1, 1, corner, std::sqrt(0.75), law), 1, 1e-3);
  }
}

/// 100 pairs of random polyhedra that meet without friction or damping.
struct Impacts {
  Lattice lattice;
  Scene scene = contact_scene(0, 1, false);
  explicit Impacts(ContactLaw law) {
    scene.contact.law = law;
    test::Random random(3);
    for (int k = 0; k < 100; ++k) {
      const Vec3<double> centre{8.0 * (k % 10), 8.0 * (k / 10), 0};
      const Vec3<double> way = random.direction();
      for (const double side : {1.0, -1.0}) {
        const Quat<double> q = random.rotation(random.uniform(0, 3));
        test::append_stone(lattice, random, centre + (1.9 * side) * way, q,
                           (-0.5 * side) * way + random.vector(0.1), random.vector(0.5));
      }
    }
  }
};

TEST(Contact, ImpactsOfRandomPolyhedraConserveEnergyAndMomentum) {
  const Impacts impacts(ContactLaw::potential);
  test::Dynamics d(impacts.scene, impacts.lattice);
  const double dt = start(d, 0.1);
  const double before = d.kinetic();
  const auto momentum = d.momentum();
  double least = before, most = 0;
  const long n = static_cast<long>(6 / dt) / 100;
  for (int k = 0; k < 100; ++k) {
    d.steps(n);
    least = std::min(least, d.kinetic());
    most = std::max(most, d.reported("contacts"));
  }
  EXPECT_GT(most, 5);                    // they do meet,
  EXPECT_LT(least, 0.97 * before);       // hard,
  EXPECT_EQ(d.reported("contacts"), 0);  // and have parted
  EXPECT_NEAR(d.kinetic(), before, 1e-3 * before);
  EXPECT_NEAR(d.reported("energy_crushing"), 0, 1e-3 * before);
  const auto after = d.momentum();
  double mass = 0;
  for (const double m : impacts.lattice.bodies.mass) mass += m;
  for (std::size_t k = 0; k < 6; ++k)
    EXPECT_NEAR(after[k], momentum[k], 1e-10 * mass * 0.5 * (k < 3 ? 1 : 60)) << k;
}

/// What is lost to the viscous term, to sliding and to crushing is what the bodies no longer have.
TEST(Contact, LedgerOfImpactsWithLosses) {
  Impacts impacts(ContactLaw::overlap);
  impacts.scene.contact.friction = 0.3;
  impacts.scene.contact.damping_ratio = 0.1;
  impacts.scene.contact.plastic_limit.pressure = 2e5;
  test::Dynamics d(impacts.scene, impacts.lattice);
  const double dt = start(d, 0.5);
  const double before = d.kinetic();
  d.steps(static_cast<long>(4 / dt));
  double lost = 0;
  for (const char* name :
       {"energy_contact", "energy_contact_viscous", "energy_friction", "energy_crushing"}) {
    EXPECT_GT(d.reported(name), name == std::string("energy_contact") ? -1e-9 : 0.01 * before);
    lost += d.reported(name);
  }
  EXPECT_NEAR(d.kinetic() + lost, before, 1e-5 * before);
}

/// A crushed block does not press again before it has sunk deeper than it was.
TEST(Contact, CrushingIsRemembered) {
  const OverlapLaw law(ContactOptions{.young = 1e7, .plastic_limit = {.pressure = 1e5}});
  const PairConstants pair{.stiffness = 1e7, .area = 1, .friction = 0, .half_space = true};
  const Mobility mobility{.a = {.mass = 1.0 / 920}};
  PairHistory memory;
  const auto at = [&](double depth) {
    Overlap o;
    o.volume = depth;  // 1 m^2 sunk by `depth`
    o.area = {0, 0, 1};
    ContactTrial trial;
    find_trial(law, pair, o, 0.5 * depth, {}, mobility, {}, {}, memory, false, trial);
    const ContactForce c = without_dashpots(trial);
    memory = history_of(trial, c.springs);
    return c.force().z;
  };
  EXPECT_DOUBLE_EQ(at(0.005), 5e4);
  EXPECT_DOUBLE_EQ(at(0.03), 1e5);  // 0.02 m stay
  EXPECT_NEAR(at(0.025), 5e4, 1e-6);
  EXPECT_EQ(at(0.015), 0);
  EXPECT_NEAR(at(0.02), 0, 1e-6);
  EXPECT_NEAR(at(0.03), 1e5, 1e-6);
}

TEST(Contact, ThatIsBornWhenABeamBreaksHasNoEnergy) {
  Lattice lattice;
  test::append_block(lattice, {1, 1, 1}, {0, 0, 0});
  test::append_block(lattice, {1, 1, 1}, {0.95, 0, 0});
  lattice.beams.bodies = {{0, 1}};
  const Part part = partition(lattice, PETSC_COMM_SELF);
  const auto contact = make_contact(part, lattice, {.young = young}, {});
  State<Spatial> state(2);
  const auto force = [&] {
    Wrenches<Spatial> w(2);
    contact->add(state, w);
    return w.of(0)[0];
  };
  EXPECT_EQ(force(), 0);  // joined
  const std::array<std::int32_t, 2> pair{0, 1};
  contact->roles().broken_pairs->release({&pair, 1});
  EXPECT_EQ(force(), 0);
  commit(*contact, state, 1e-3);
  EXPECT_EQ(force(), 0);
  state.record(1)[0] = -0.01;  // nearer than they were born
  EXPECT_NEAR(force(), -young * 0.01, 1e-6 * young);
}

/// A beam that breaks makes its own pair stress-free, and no pair that might touch before. The same
/// holds where the run goes on from a checkpoint before the list is built anew.
TEST(Contact, OfOtherPairsIsNotBornWhenABeamBreaks) {
  Lattice lattice;
  for (const double x : {0.0, 0.95, 5.0, 6.01}) test::append_block(lattice, {1, 1, 1}, {x, 0, 0});
  lattice.beams.bodies = {{0, 1}};
  const Part part = partition(lattice, PETSC_COMM_SELF);
  const auto run = make_contact(part, lattice, {.young = young}, {});
  State<Spatial> state(4);
  const auto force = [&](Contact& contact, std::size_t body) {
    Wrenches<Spatial> w(4);
    contact.add(state, w);
    return w.of(body)[0];
  };
  EXPECT_EQ(force(*run, 0), 0);
  EXPECT_EQ(force(*run, 2), 0);
  commit(*run, state, 1e-3);
  const std::array<std::int32_t, 2> pair{0, 1};
  run->roles().broken_pairs->release({&pair, 1});
  const auto restarted = make_contact(part, lattice, {.young = young}, {});
  for (const Transfer way : {Transfer::save, Transfer::load}) {
    Hdf5File file =
        way == Transfer::save ? Hdf5File::create("contact.h5") : Hdf5File::open("contact.h5");
    Archive memory(part, &file, way);
    (way == Transfer::save ? run : restarted)->roles().persists->persist(memory);
    if (way == Transfer::save) file.close();
  }
  state.record(3)[0] = -0.02;  // this pair touches for the first time
  for (Contact* contact : {run.get(), restarted.get()}) {
    EXPECT_EQ(force(*contact, 0), 0);
    EXPECT_NEAR(force(*contact, 2), -young * 0.01, 1e-6 * young);
  }
}

/// New faces press with their own modulus; other pairs do not.
TEST(Contact, OfNewFacesHasItsOwnModulus) {
  Lattice lattice;
  for (const double x : {0.0, 0.95, 5.0, 5.99}) test::append_block(lattice, {1, 1, 1}, {x, 0, 0});
  lattice.beams.bodies = {{0, 1}};
  const Part part = partition(lattice, PETSC_COMM_SELF);
  const auto contact =
      make_contact(part, lattice, {.young = young, .young_broken = 40 * young}, {});
  State<Spatial> state(4);
  const auto force = [&](std::size_t body) {
    Wrenches<Spatial> w(4);
    contact->add(state, w);
    return w.of(body)[0];
  };
  EXPECT_EQ(force(0), 0);
  const std::array<std::int32_t, 2> pair{0, 1};
  contact->roles().broken_pairs->release({&pair, 1});
  EXPECT_EQ(force(0), 0);
  commit(*contact, state, 1e-3);
  state.record(1)[0] = -0.001;
  EXPECT_NEAR(force(0), -40 * young * 0.001, 1e-6 * young);
  EXPECT_NEAR(force(2), -young * 0.01, 1e-6 * young);
  // The stable step allows for them.
  const auto softer = make_contact(part, lattice, {.young = young}, {});
  EXPECT_NEAR(contact->roles().step->stiffness_bound(0),
              40 * softer->roles().step->stiffness_bound(0), 1);
  EXPECT_NEAR(softer->roles().step->resolved_step(),
              std::sqrt(40) * contact->roles().step->resolved_step(), 1e-9);
}

/// Weights that stand beside a floor's point turn it: r x F.
TEST(Contact, MomentOnAnObstacleIsAboutItsPoint) {
  Scene scene = contact_scene(0.3, 0.3);
  scene.obstacles.push_back(box({1, -2, -0.5}, {20, 20, 1}, {0, 0, 0}));
  scene.obstacles.back().name = "floor";
  Lattice lattice;
  test::append_block(lattice, {1, 1, 1}, {3, 4, 0.5 - 920 * g / (2 * young)});
  test::Dynamics d(scene, lattice);
  const double dt = start(d);
  d.steps(static_cast<long>(1 / dt));
  const double weight = 920 * g;
  EXPECT_NEAR(d.reported("floor_force_z"), -weight, 1e-6 * weight);
  EXPECT_NEAR(d.reported("floor_moment_x"), (4 + 2) * -weight, 1e-6 * weight);
  EXPECT_NEAR(d.reported("floor_moment_y"), -(3 - 1) * -weight, 1e-6 * weight);
  EXPECT_NEAR(d.reported("floor_moment_z"), 0, 1e-6 * weight);
}

/// A plate that is moved against a block on a floor pushes with mu m g and does that work.
TEST(Contact, MovingObstacleDoesWork) {
  Scene scene = contact_scene(0.4, 0.3);
  add_plane(scene, {0, 0, 1});
  scene.obstacles.push_back(box({-1, 0, 0.5}, {1, 4, 0.6}, {0, 0, 0}));
  scene.obstacles.back().name = "ram";
  scene.obstacles.back().motion.velocity = {0.2, 0, 0};
  Lattice lattice;
  test::append_block(lattice, {1, 1, 1}, {0, 0, 0.5 - 920 * g / (2 * young)});
  test::Dynamics d(scene, lattice);
  start(d);
  const auto run_to = [&](double time) {
    while (d.state().time < time) (void)d.step();
  };
  run_to(1);
  const double work = d.reported("energy_external");
  run_to(3);
  const double force = 0.4 * 920 * g;
  EXPECT_NEAR(-d.reported("ram_force_x"), force, 0.01 * force);
  EXPECT_NEAR(d.reported("energy_external") - work, force * 0.2 * 2, 0.01 * force * 0.4);
  EXPECT_NEAR(d.reported("floor_mean_force_z"), -920 * g, 0.01 * 920 * g);
  EXPECT_GT(std::abs(d.reported("ram_peak_force_x")), 0.999 * force);
  EXPECT_NEAR(displacement(d.state(), 0).x, 0.2 * 3, 0.02);
}

}  // namespace
}  // namespace floe
