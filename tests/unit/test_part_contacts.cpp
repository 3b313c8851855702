// Obstacles of several parts: forces do not depend on how a shape is cut into parts.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "active_contacts/contacts.h"
#include "support/blocks.h"

namespace floe {
namespace {

/// A box that is cut into nx x ny x nz boxes.
Obstacle cut_box(const Vec3<double>& centre, const Vec3<double>& size, int nx, int ny, int nz) {
  Obstacle whole;
  for (int i = 0; i < nx; ++i)
    for (int j = 0; j < ny; ++j)
      for (int k = 0; k < nz; ++k) {
        const Vec3<double> edge{size.x / nx, size.y / ny, size.z / nz};
        const Vec3<double> low = centre - 0.5 * size;
        const Obstacle part =
            box(low + Vec3<double>{(i + 0.5) * edge.x, (j + 0.5) * edge.y, (k + 0.5) * edge.z},
                edge, {});
        if (whole.parts.empty())
          whole = part;
        else
          add_parts(whole, part);
      }
  return whole;
}

/// A body that is set to places by hand beside an obstacle.
struct Beside {
  Lattice lattice;
  Contacts contacts;
  Vec3<double> point;
  double time = 0;

  Beside(const Lattice& body, const ContactOptions& options, const Obstacle& obstacle)
      : lattice(body),
        contacts(lattice.shapes, lattice.bodies.mass, {}, options, {obstacle}),
        point(obstacle.point) {}

  /// Returns the wrench on the body after a step, and sets that on the obstacle about the origin.
  ContactWrench step(const MovingPose& body, ContactWrench& on_obstacle) {
    constexpr double dt = 1e-3;
    contacts.build(std::vector{body.pose}, std::vector<std::uint8_t>(1, 1), time);
    std::vector<MovingPose> bodies;
    if (!contacts.list().involved().empty()) bodies.push_back(body);
    std::vector<ContactWrench> wrenches(bodies.size());
    contacts.place(bodies, time, time - 0.5 * dt);
    contacts.evaluate(wrenches);
    if (contacts.damps()) contacts.damp(std::vector<Acceleration>(bodies.size()), wrenches);
    on_obstacle = contacts.on_obstacle(0);
    on_obstacle.moment = on_obstacle.moment + cross(point, on_obstacle.force);
    contacts.commit();
    if (contacts.wears()) contacts.wear(contacts.cuts());
    time += dt;
    return bodies.empty() ? ContactWrench{} : wrenches[0];
  }
};

Lattice one_block(const Vec3<double>& size) {
  Lattice lattice;
  test::append_block(lattice, size, {0, 0, 0});
  return lattice;
}

void expect_same(const ContactWrench& p, const ContactWrench& q, double of, const char* what,
                 int step) {
  ASSERT_LE(length(p.force - q.force), of) << what << " " << step;
  ASSERT_LE(length(p.moment - q.moment), of) << what << " " << step;
}

/// A block slides, turns and rocks over the top of a box, of which the second is cut into parts.
void slide(const ContactOptions& options, const Obstacle& whole, const Obstacle& parts,
           double relative) {
  const Lattice block = one_block({1.1, 0.7, 0.5});
  Beside one(block, options, whole), several(block, options, parts);
  double most = 0;
  int over_several = 0;
  for (int step = 0; step < 400; ++step) {
    const double s = 0.01 * step;
    MovingPose body;
    body.pose.x = {-1.7 + s, 0.3 * std::sin(s), 0.22 + 0.03 * std::sin(9 * s)};
    body.pose.q = exp_rotation({0.04 * std::sin(3 * s), 0.05 * std::cos(2 * s), 0.8 * s});
    body.velocity = {10, 3 * std::cos(s), 2.7 * std::cos(9 * s)};
    body.spin = {0.12 * std::cos(3 * s), -0.1 * std::sin(2 * s), 8};
    ContactWrench on_one, on_several;
    const ContactWrench expected = one.step(body, on_one), got = several.step(body, on_several);
    most = std::max(most, length(expected.force) + length(expected.moment));
    expect_same(got, expected, relative * most, "body", step);
    expect_same(on_several, on_one, 5 * relative * most, "obstacle", step);
    ASSERT_EQ(several.contacts.touching(), one.contacts.touching()) << step;
    over_several = std::max(over_several, static_cast<int>(several.contacts.list().size()));
    const ContactEnergies e = one.contacts.energies({}), f = several.contacts.energies({});
    ASSERT_NEAR(e.stored, f.stored, 10 * relative * std::max(1.0, std::abs(e.stored))) << step;
  }
  EXPECT_GT(most, 1e3);
  EXPECT_GE(over_several, std::min<int>(3, static_cast<int>(parts.parts.size())));
}

TEST(PartContacts, ABoxCutIntoPartsIsTheBox) {
  const Obstacle whole = box({0, 0, -1}, {4, 2, 2}, {});
  for (const ContactLaw law : {ContactLaw::overlap, ContactLaw::potential}) {
    for (const double restitution : {1.0, 0.3}) {
      ContactOptions options{.law = law, .young = 1e7, .friction = 0.3};
      options.damping_ratio = restitution < 1 ? 0.36 : 0;
      slide(options, whole, cut_box({0, 0, -1}, {4, 2, 2}, 5, 2, 3), 1e-10);
      slide(options, whole, cut_box({0, 0, -1}, {4, 2, 2}, 1, 3, 2), 1e-10);
    }
  }
}

/// What contacts crush, and the body loses, does not depend on parts.
TEST(PartContacts, CrushingGoesOnFromPartToPart) {
  const Obstacle whole = box({0, 0, -1}, {4, 2, 2}, {});
  for (const ContactLaw law : {ContactLaw::overlap, ContactLaw::potential}) {
    const ContactOptions options{
        .law = law, .young = 1e7, .friction = 0.3, .plastic_limit = {.pressure = 5e4}};
    slide(options, whole, cut_box({0, 0, -1}, {4, 2, 2}, 7, 3, 2), 1e-9);
  }
}

TEST(PartContacts, InnerFacesAreWhatPartsHaveInCommon) {
  const Obstacle cut = cut_box({1, 2, 3}, {4, 2, 2}, 2, 2, 1);
  ASSERT_EQ(cut.parts.size(), 4U);
  for (const ConvexPart& part : cut.parts) EXPECT_EQ(part.inner_faces.size(), 2U);
  Obstacle ell = box({0.5, 0.5, 1}, {1, 1, 2}, {});  // an L: two boxes, one lower
  add_parts(ell, box({1.5, 0.5, 0.25}, {1, 1, 0.5}, {}));
  ASSERT_EQ(ell.parts[0].inner_faces.size(), 1U);
  ASSERT_EQ(ell.parts[1].inner_faces.size(), 1U);
  double area = 0;
  const auto& corners = ell.parts[0].inner_faces[0].corners;
  for (std::size_t k = 1; k + 1 < corners.size(); ++k)
    area += 0.5 * length(cross(corners[k] - corners[0], corners[k + 1] - corners[0]));
  EXPECT_NEAR(area, 0.5, 1e-12);
  EXPECT_FALSE(overlap_of_parts(ell));
  add_parts(ell, box({1.5, 0.5, 0.5}, {1, 1, 0.5}, {}));
  const auto overlap = overlap_of_parts(ell);
  ASSERT_TRUE(overlap);
  EXPECT_EQ(overlap->one, 1);
  EXPECT_EQ(overlap->other, 2);
  EXPECT_NEAR(overlap->volume, 0.25, 1e-12);
}

/// An L that is cut upright or level. A block in its corner presses on both legs at once.
TEST(PartContacts, AnEllIsTheSameHoweverItIsCut) {
  Obstacle upright = box({0.5, 0.5, 1}, {1, 1, 2}, {});
  add_parts(upright, box({1.5, 0.5, 0.5}, {1, 1, 1}, {}));
  Obstacle level = box({1, 0.5, 0.5}, {2, 1, 1}, {});
  add_parts(level, box({0.5, 0.5, 1.5}, {1, 1, 1}, {}));
  const ContactOptions options{.law = ContactLaw::potential, .young = 1e7, .friction = 0.3};
  const Lattice block = one_block({0.5, 0.5, 0.5});
  Beside one(block, options, upright), other(block, options, level);
  double most = 0;
  for (int step = 0; step < 100; ++step) {
    const double s = 0.01 * step;
    MovingPose body;
    body.pose.x = {1.24 + 0.03 * std::sin(7 * s), 0.5, 1.24 + 0.03 * std::cos(5 * s)};
    body.pose.q = exp_rotation({0, 0.1 * s, 0.2 * s});
    body.velocity = {0.21 * std::cos(7 * s), 0, -0.15 * std::sin(5 * s)};
    ContactWrench on_one, on_other;
    const ContactWrench p = one.step(body, on_one), q = other.step(body, on_other);
    most = std::max(most, length(p.force));
    expect_same(p, q, 1e-10 * most, "body", step);
    expect_same(on_one, on_other, 1e-9 * most, "obstacle", step);
  }
  EXPECT_GT(most, 1e3);
}

/// Opposite walls press against each other; joined into one contact their areas would cancel.
TEST(PartContacts, OppositeWallsAreContactsOfTheirOwn) {
  Obstacle slot = box({0, 0, -0.5}, {3, 1, 1}, {});
  add_parts(slot, box({-1, 0, 1}, {1, 1, 2}, {}));
  add_parts(slot, box({1, 0, 1}, {1, 1, 2}, {}));
  for (const ContactLaw law : {ContactLaw::overlap, ContactLaw::potential}) {
    const ContactOptions options{.law = law, .young = 1e7, .friction = 0};
    Beside jammed(one_block({1.02, 0.5, 0.5}), options, slot);
    ContactWrench on_slot;
    MovingPose body;
    body.pose = {{0.004, 0, 1}, {1, 0, 0, 0}};
    const ContactWrench on_body = jammed.step(body, on_slot);
    EXPECT_EQ(jammed.contacts.touching(), 2);
    // k_v V of 14 and 6 mm, or k_v V |S|; A_r is L^2
    const double size = std::cbrt(1.02 * 0.25), k = 1e7 / (0.5 * size);
    const double share = law == ContactLaw::overlap ? 1 : 0.25 / (size * size);
    EXPECT_NEAR(on_body.force.x, -k * 0.25 * 0.008 * share, 1e-6 * k * share * 0.25);
    EXPECT_NEAR(on_slot.force.x, -on_body.force.x, 1e-9 * std::abs(on_body.force.x));
    body.pose.x = {0, 0, 0.24};  // on the bottom too: the three meet at the corners
    jammed.step(body, on_slot);
    EXPECT_EQ(jammed.contacts.touching(), 1);
  }
}

TEST(PartContacts, ABodyInsideSeveralPartsFeelsNothing) {
  const ContactOptions options{.young = 1e7, .friction = 0};
  Beside inside(one_block({0.5, 0.5, 0.5}), options, cut_box({}, {4, 4, 4}, 2, 2, 2));
  ContactWrench on_obstacle;
  MovingPose body;
  body.pose.q = exp_rotation({0.3, 0.2, 0.1});
  const ContactWrench on_body = inside.step(body, on_obstacle);
  EXPECT_EQ(length(on_body.force), 0);
  EXPECT_EQ(length(on_body.moment), 0);
}

/// Returns an obstacle whose frame has its origin at that of the world, on a body.
Obstacle carried(const Obstacle& obstacle, std::int32_t body, double friction) {
  Shapes shapes = shapes_of_parts(obstacle);
  for (Vec3<double>& r : shapes.vertices) r = r + obstacle.point;
  Obstacle moved = polyhedra(shapes, {});
  moved.body = body;
  moved.friction = friction;
  return moved;
}

/// Bodies that are set to places by hand.
struct Two {
  Contacts contacts;
  double time = 0;

  Two(const Lattice& lattice, const ContactOptions& options,
      const std::vector<Obstacle>& obstacles = {})
      : contacts(lattice.shapes, lattice.bodies.mass, {}, options, obstacles,
                 lattice.bodies.inertia) {}

  /// Returns the wrenches on both after a step.
  std::vector<ContactWrench> step(const std::vector<MovingPose>& bodies) {
    constexpr double dt = 1e-3;
    std::vector<Pose> poses;
    for (const MovingPose& body : bodies) poses.push_back(body.pose);
    contacts.build(poses, std::vector<std::uint8_t>(bodies.size(), 1), time);
    std::vector<MovingPose> involved;
    for (const std::int32_t b : contacts.list().involved())
      involved.push_back(bodies[static_cast<std::size_t>(b)]);
    std::vector<ContactWrench> wrenches(involved.size());
    contacts.place(involved, time, time - 0.5 * dt);
    contacts.evaluate(wrenches);
    if (contacts.damps()) contacts.damp(std::vector<Acceleration>(involved.size()), wrenches);
    contacts.commit();
    time += dt;
    wrenches.resize(bodies.size());  // nothing acts where nobody is involved
    return wrenches;
  }
};

/// One block slides, turns and rocks over another, which tilts.
std::vector<MovingPose> slide_at(double s) {
  MovingPose above, below;
  above.pose.x = {-1.7 + s, 0.3 * std::sin(s), 0.72 + 0.03 * std::sin(9 * s)};
  above.pose.q = exp_rotation({0.04 * std::sin(3 * s), 0.05 * std::cos(2 * s), 0.8 * s});
  above.velocity = {10, 3 * std::cos(s), 2.7 * std::cos(9 * s)};
  above.spin = {0.12 * std::cos(3 * s), -0.1 * std::sin(2 * s), 8};
  below.pose.x = {0, 0, 0.02 * std::sin(5 * s)};
  below.pose.q = exp_rotation({0.01 * std::sin(4 * s), 0, 0.3 * s});
  below.velocity = {0, 0, 1 * std::cos(5 * s)};
  below.spin = {0.4 * std::cos(4 * s), 0, 3};
  return {above, below};
}

/// Obstacles that bodies carry touch as these bodies would: the first block's wrench is that of
/// bodies of ice, however the shapes are cut, and momentum stays.
TEST(PartContacts, ObstaclesOfTwoBodiesTouchAsTheBodies) {
  const Vec3<double> small{1.1, 0.7, 0.5}, large{3.8, 2, 1};
  Lattice lattice;
  test::append_block(lattice, small, {});
  test::append_block(lattice, large, {});
  for (const ContactLaw law : {ContactLaw::overlap, ContactLaw::potential}) {
    for (const double damping : {0.0, 0.36}) {
      ContactOptions options{.law = law, .young = 1e7, .friction = 0.3};
      options.damping_ratio = damping;
      Two ice(lattice, options),
          whole(lattice, options,
                {carried(box({}, small, {}), 0, 0.3), carried(box({}, large, {}), 1, 0.2)}),
          cut(lattice, options,
              {carried(cut_box({}, small, 2, 1, 2), 0, 0.3),
               carried(cut_box({}, large, 3, 2, 2), 1, 0.3)});
      double most = 0;
      std::size_t pairs = 0;
      for (int step = 0; step < 400; ++step) {
        const std::vector<MovingPose> at = slide_at(0.01 * step);
        const auto expected = ice.step(at);
        const auto one = whole.step(at), several = cut.step(at);
        for (std::size_t b = 0; b < 2; ++b)
          most = std::max(most, length(expected[b].force) + length(expected[b].moment));
        for (std::size_t b = 0; b < 2; ++b) {
          expect_same(one[b], expected[b], 1e-10 * most, "whole", step);
          expect_same(several[b], expected[b], 1e-10 * most, "cut", step);
        }
        expect_same({several[0].force + several[1].force, {}}, {}, 1e-13 * most, "sum", step);
        ASSERT_EQ(cut.contacts.touching(), ice.contacts.touching()) << step;
        pairs = std::max(pairs, cut.contacts.list().size());
      }
      EXPECT_GT(most, 1e3);
      EXPECT_GE(pairs, 8U);
    }
  }
}

/// A block carries two obstacles, one in the other, and slides on a plane and a box: as
/// a block of ice does, with the box as a body of no size.
TEST(PartContacts, AnObstacleOfABodyTouchesFixedObstacles) {
  const Vec3<double> size{1.1, 0.7, 0.5};
  const Lattice lattice = one_block(size);
  const Obstacle block = carried(cut_box({}, size, 2, 2, 1), 0, 0.1),
                 knob = carried(box({}, {0.2, 0.2, 0.2}, {}), 0, 0.1);
  const ContactOptions options{.young = 1e7, .friction = 0.2};
  Obstacle plane = half_space({0, 0, -0.5}, {0, 0, 1}), stone = box({2, 0, -0.69}, {2, 2, 0.4}, {});
  plane.friction = stone.friction = 0.2;
  Two ice(lattice, options, {plane, stone}),
      of_parts(lattice, options, {block, plane, stone, knob});
  double most = 0;
  for (int step = 0; step < 300; ++step) {
    const double s = 0.01 * step;
    MovingPose body;
    body.pose.x = {s, 0, -0.25 - 0.02 * std::cos(7 * s)};
    body.pose.q = exp_rotation({0.02 * std::sin(3 * s), 0.03 * std::sin(5 * s), 0.2 * s});
    body.velocity = {10, 0, 14 * std::sin(7 * s)};
    const auto expected = ice.step({body}), got = of_parts.step({body});
    most = std::max(most, length(expected[0].force));
    expect_same(got[0], expected[0], 1e-10 * most, "block", step);
    for (const std::size_t k : {0U, 1U})
      expect_same(of_parts.contacts.on_obstacle(k + 1), ice.contacts.on_obstacle(k), 1e-10 * most,
                  "obstacle", step);
  }
  EXPECT_GT(most, 1e3);
}

}  // namespace
}  // namespace floe
