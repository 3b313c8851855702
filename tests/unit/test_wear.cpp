// What contacts crush is lost to the body (model.md, "Contact").

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "active_contacts/contacts.h"
#include "support/blocks.h"

namespace floe {
namespace {

constexpr double young = 1e7;
const Quat<double> upright{1, 0, 0, 0};
const Quat<double> on_edge = exp_rotation({0, 0.25 * std::numbers::pi, 0});
const Quat<double> on_corner = product(exp_rotation({std::atan(std::sqrt(0.5)), 0, 0}), on_edge);

/// Bodies and obstacles that are set to places by hand.
struct Press {
  Contacts contacts;
  std::vector<MovingPose> bodies;
  std::vector<ContactWrench> wrenches;

  Press(const Lattice& lattice, const ContactOptions& options, std::vector<Obstacle> obstacles)
      : contacts(lattice.shapes, lattice.bodies.mass, {}, options, std::move(obstacles)),
        bodies(lattice.bodies.mass.size()),
        wrenches(bodies.size()) {
    for (std::size_t b = 0; b < bodies.size(); ++b)
      bodies[b].pose = {lattice.bodies.position[b], upright};
  }
  /// One step: the force on body 0, and the commit.
  Vec3<double> step() {
    std::vector<Pose> poses;
    for (const MovingPose& body : bodies) poses.push_back(body.pose);
    contacts.build(poses, std::vector<std::uint8_t>(bodies.size(), 1), 0);
    std::vector<MovingPose> involved;
    for (const std::int32_t b : contacts.list().involved())
      involved.push_back(bodies[static_cast<std::size_t>(b)]);
    wrenches.assign(involved.size(), {});
    contacts.place(involved, 0, 0);
    contacts.evaluate(wrenches);
    contacts.commit();
    contacts.wear(contacts.cuts());
    return contacts.list().involved().empty() || contacts.list().involved()[0] != 0
               ? Vec3<double>{}
               : wrenches[0].force;
  }
  /// Sets body 0 and makes a step.
  Vec3<double> at(const Vec3<double>& x, const Quat<double>& q) {
    bodies[0].pose = {x, q};
    return step();
  }
};

/// How far a cube of 1 m reaches below its centroid, and the volume below a depth of its lowest
/// point, in three attitudes.
struct Attitude {
  Quat<double> q;
  double reach;
  double (*volume)(double depth);
  double (*area)(double depth);
};
const std::array<Attitude, 3> attitudes{
    Attitude{upright, 0.5, [](double x) { return x; }, [](double) { return 1.0; }},
    Attitude{on_edge, std::sqrt(0.5), [](double x) { return x * x; },
             [](double x) { return 2 * x; }},
    // A corner of three right angles: V = (sqrt(3)/2) x^3, A its derivative.
    Attitude{on_corner, std::sqrt(0.75), [](double x) { return 0.5 * std::sqrt(3) * x * x * x; },
             [](double x) { return 1.5 * std::sqrt(3) * x * x; }}};

Lattice one_cube() {
  Lattice lattice;
  test::append_block(lattice, {1, 1, 1}, {0, 0, 1});
  return lattice;
}
const Obstacle floor_plane = half_space({0, 0, 0}, {0, 0, 1});

/// A face, an edge and a corner crush, part, come again: they feel nothing until they are as deep
/// as they were when they parted, and press on from there by k_v (V - V_p).
TEST(Wear, CrushedPartsFeelNothingUntilTheyAreAsDeepAgain) {
  constexpr double k = young / 0.5, deep = 0.05, limit = 1e3;
  for (const ContactLaw law : {ContactLaw::overlap, ContactLaw::potential}) {
    for (const Attitude& attitude : attitudes) {
      const ContactOptions options{
          .law = law, .young = young, .friction = 0, .plastic_limit = {.pressure = limit}};
      const Lattice lattice = one_cube();
      Press press(lattice, options, {floor_plane});
      const auto force = [&](double depth) {
        return press.at({0, 0, attitude.reach - depth}, attitude.q).z;
      };
      const double area = attitude.area(deep);
      EXPECT_NEAR(force(deep), limit * area, 1e-7 * limit * area);
      const double elastic = limit * area / (law == ContactLaw::overlap ? k : k * area);
      const double plastic = attitude.volume(deep) - elastic;
      ASSERT_GT(plastic, 0);
      EXPECT_TRUE(press.contacts.worn().none());
      EXPECT_EQ(force(-0.01), 0);
      EXPECT_EQ(press.contacts.worn().of(0).size(), 1U);
      for (const double depth : {0.2 * deep, 0.6 * deep, deep}) {
        const double left = std::max(attitude.volume(depth) - plastic, 0.0);
        const double expected = k * left * (law == ContactLaw::overlap ? 1 : attitude.area(depth));
        EXPECT_NEAR(force(depth), expected, 1e-7 * limit * area) << depth;
        EXPECT_EQ(press.contacts.touching(), left > 0 ? 1 : 0);
      }
      // Another place of the same body is whole: turned over, its upper face, edge or corner.
      EXPECT_EQ(force(-0.01), 0);
      const Quat<double> over = product(exp_rotation({std::numbers::pi, 0, 0}), attitude.q);
      const double slight = 1e-3 * deep, volume = attitude.volume(slight);
      EXPECT_NEAR(press.at({0, 0, attitude.reach - slight}, over).z,
                  k * volume * (law == ContactLaw::overlap ? 1 : attitude.area(slight)),
                  1e-6 * k * volume);
    }
  }
}

/// What one obstacle has crushed another one does not meet; without wear a body heals.
TEST(Wear, BelongsToTheBody) {
  const Attitude& corner = attitudes[2];
  const Lattice lattice = one_cube();
  for (const bool wear : {true, false}) {
    Press press(lattice,
                {.young = young, .friction = 0, .plastic_limit = {.pressure = 1e5}, .wear = wear},
                {floor_plane, box({20, 0, -1}, {8, 8, 2}, {0, 0, 0})});
    (void)press.at({0, 0, corner.reach - 0.05}, corner.q);
    (void)press.at({0, 0, 2}, corner.q);
    EXPECT_EQ(press.contacts.worn().none(), !wear);
    for (const double x : {0.0, 20.0}) {
      EXPECT_EQ(press.at({x, 0, corner.reach - 0.03}, corner.q).z == 0, wear) << x;
      (void)press.at({0, 0, 2}, corner.q);
    }
  }
}

/// Of a corner that is pressed into a face the corner's body loses what is crushed, whichever of
/// the two comes first.
TEST(Wear, TheSharperBodyLoses) {
  const Attitude& corner = attitudes[2];
  for (const std::int32_t sharp : {0, 1}) {
    Lattice lattice;
    test::append_block(lattice, {1, 1, 1}, {0, 0, 0});
    test::append_block(lattice, {1, 1, 1}, {0, 0, 0});
    Press press(lattice, {.young = young, .friction = 0, .plastic_limit = {.pressure = 1e5}}, {});
    const auto s = static_cast<std::size_t>(sharp);
    press.bodies[1 - s].pose = {{0, 0, -0.5}, upright};
    const auto force = [&](double depth) {
      press.bodies[s].pose = {{0, 0, corner.reach - depth}, corner.q};
      return std::abs(press.step().z);
    };
    EXPECT_NEAR(force(0.05), 1e5 * corner.area(0.05), 1e-5 * 1e5 * corner.area(0.05));
    EXPECT_EQ(force(-0.01), 0);
    EXPECT_EQ(press.contacts.worn().of(sharp).size(), 1U);
    EXPECT_EQ(press.contacts.worn().of(1 - sharp).size(), 0U);
    EXPECT_EQ(force(0.03), 0);
    EXPECT_NEAR(force(0.05), 1e5 * corner.area(0.05), 1e-5 * 1e5 * corner.area(0.05));
  }
}

/// An overlap with which a contact is born was not crushed.
TEST(Wear, StressFreeOverlapsAreNoWear) {
  const Lattice lattice = one_cube();
  Press press(lattice,
              {.young = young,
               .friction = 0,
               .plastic_limit = {.pressure = 1e5},
               .initial_overlap = InitialOverlap::stress_free},
              {floor_plane});
  EXPECT_EQ(press.at({0, 0, 0.48}, upright).z, 0);
  EXPECT_GT(press.at({0, 0, 0.477}, upright).z, 0);
  EXPECT_EQ(press.at({0, 0, 0.51}, upright).z, 0);
  EXPECT_TRUE(press.contacts.worn().none());
  // What was crushed on top of it is.
  EXPECT_NEAR(press.at({0, 0, 0.45}, upright).z, 1e5, 1e-3);
  (void)press.at({0, 0, 0.51}, upright);
  ASSERT_EQ(press.contacts.worn().of(0).size(), 1U);
  EXPECT_NEAR(press.contacts.worn().of(0)[0].offset, 0.5 - (0.05 - 1e5 / (young / 0.5)), 1e-9);
}

/// Planes beyond which nothing is left are forgotten; of many the least crushed one is.
TEST(Wear, KeepsFewPlanes) {
  const Lattice lattice = one_cube();
  const Solids solids(lattice.shapes, lattice.bodies.mass, {});
  Wear wear;
  const auto cut = [&](const Vec3<double>& out, double offset, double volume) {
    wear.add(solids, {.body = 0, .left = {(1 / length(out)) * out, offset}, .volume = volume});
  };
  cut({0, 0, -1}, 0.45, 1e-3);
  cut({0, 0.01, -1}, 0.4, 1e-3);  // deeper everywhere
  ASSERT_EQ(wear.of(0).size(), 1U);
  EXPECT_EQ(wear.of(0)[0].offset, 0.4);
  for (int k = 0; k < 8; ++k)
    cut({k % 2 < 1 ? 1.0 : -1.0, k / 2 % 2 < 1 ? 1.0 : -1.0, k / 4 < 1 ? 1.0 : 0.9}, 0.8,
        k == 3 ? 1e-6 : 1e-4);
  ASSERT_EQ(wear.of(0).size(), Wear::most);
  EXPECT_EQ(wear.of(0)[0].offset, 0.4);
  Wear copy;
  copy.restore(solids, wear.rows());
  EXPECT_EQ(copy.rows(), wear.rows());
  EXPECT_EQ(copy.of(0).size(), wear.of(0).size());
}

/// The plane of a cap holds the volume; what is lost already does not count.
TEST(Wear, CapsHaveTheirVolume) {
  const Lattice lattice = one_cube();
  const Solids solids(lattice.shapes, lattice.bodies.mass, {});
  CapFinder caps;
  Wear wear;
  const Vec3<double> diagonal{std::sqrt(1 / 3.0), std::sqrt(1 / 3.0), std::sqrt(1 / 3.0)};
  const auto corner = caps.find(solids, wear, 0, diagonal, attitudes[2].volume(0.1));
  EXPECT_NEAR(corner.left.offset, std::sqrt(0.75) - 0.1, 1e-12);
  EXPECT_NEAR(corner.height, 0.1, 1e-4);
  wear.add(solids, {.body = 0, .left = corner.left, .volume = attitudes[2].volume(0.1)});
  const auto more =
      caps.find(solids, wear, 0, diagonal, attitudes[2].volume(0.2) - attitudes[2].volume(0.1));
  EXPECT_NEAR(more.left.offset, std::sqrt(0.75) - 0.2, 1e-12);
  EXPECT_NEAR(more.height, 0.1, 1e-6);
  // At most half of a body.
  EXPECT_NEAR(caps.find(solids, Wear{}, 0, {0, 0, 1}, 0.9).left.offset, 0, 1e-12);
}

}  // namespace
}  // namespace floe
