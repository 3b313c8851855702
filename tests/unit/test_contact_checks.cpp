// What a user hears of contacts: overlaps at the start, steps in which bodies move too far, bodies
// that are pressed through others.

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "contact_force/checks.h"
#include "support/contact_scene.h"

namespace {

using namespace floe;
using test::contact_scene;

constexpr double infinite = std::numeric_limits<double>::infinity();

/// A contact force that a test can ask.
struct Asked {
  Asked(const Scene& scene, const Lattice& lattice) : dynamics(scene, lattice) {
    for (const auto& force : dynamics.model().forces()) {
      if (auto* c = dynamic_cast<Contact*>(force.get())) contact = c;
    }
    if (contact == nullptr) throw std::logic_error("the scene has no contact");
  }
  Contact& force() { return *contact; }
  test::Dynamics dynamics;
  Contact* contact = nullptr;
};

/// Evaluated once, at rest.
Contacts at_start(const Lattice& lattice, const ContactOptions& options,
                  std::vector<Obstacle> obstacles = {}) {
  Contacts contacts(lattice.shapes, lattice.bodies.mass, {}, options, std::move(obstacles));
  std::vector<Pose> poses;
  for (std::size_t b = 0; b < lattice.bodies.position.size(); ++b) {
    const auto& q = lattice.bodies.orientation[b];
    poses.push_back({lattice.bodies.position[b], {q[0], q[1], q[2], q[3]}});
  }
  contacts.build(poses, std::vector<std::uint8_t>(poses.size(), 1), 0);
  std::vector<MovingPose> moving;
  for (const std::int32_t b : contacts.list().involved())
    moving.push_back({poses[static_cast<std::size_t>(b)], {}, {}});
  contacts.place(moving, 0, 0);
  std::vector<ContactWrench> wrenches(moving.size());
  contacts.evaluate(wrenches);
  return contacts;
}

Lattice two_cubes(double overlap) {
  Lattice lattice;
  test::append_block(lattice, {1, 1, 1}, {0, 0, 0});
  test::append_block(lattice, {1, 1, 1}, {0, 0, 1 - overlap});
  return lattice;
}

TEST(ContactStart, PenetrationIsMeasuredAlongTheNormal) {
  const Contacts faces = at_start(two_cubes(0.02), {});
  ASSERT_EQ(faces.penetrations().size(), 1U);
  EXPECT_NEAR(faces.penetrations()[0].depth, 0.02, 1e-12);
  EXPECT_NEAR(faces.penetrations()[0].share, 0.02, 1e-12);

  // A cube of 2 m on its corner, 0.05 m deep in a floor.
  Lattice lattice;
  const Vec3<double> axis{1 / std::sqrt(2.0), -1 / std::sqrt(2.0), 0};
  test::append_block(lattice, {2, 2, 2}, {0, 0, std::sqrt(3.0) - 0.05},
                     exp_rotation(std::acos(1 / std::sqrt(3.0)) * axis));
  const Contacts corner = at_start(lattice, {}, {half_space({0, 0, 0}, {0, 0, 1})});
  ASSERT_EQ(corner.penetrations().size(), 1U);
  EXPECT_NEAR(corner.penetrations()[0].depth, 0.05, 1e-12);
  EXPECT_NEAR(corner.penetrations()[0].share, 0.025, 1e-12);

  // Against a thin plate its width counts.
  Lattice cube;
  test::append_block(cube, {1, 1, 1}, {0, 0, 0});
  const Contacts plate = at_start(cube, {}, {box({0, 0, -0.51}, {3, 3, 0.1}, {0, 0, 0})});
  ASSERT_EQ(plate.penetrations().size(), 1U);
  EXPECT_NEAR(plate.penetrations()[0].depth, 0.04, 1e-12);
  EXPECT_NEAR(plate.penetrations()[0].share, 0.4, 1e-12);
}

TEST(ContactStart, LeastWidthIsBetweenParallelFaces) {
  Lattice lattice;
  test::append_block(lattice, {3, 0.2, 1}, {0, 0, 0}, exp_rotation({0.3, 0.2, 0.5}));
  const Contacts contacts(lattice.shapes, lattice.bodies.mass, {}, {},
                          {half_space({0, 0, -9}, {0, 0, 1}), box({9, 0, 0}, {4, 5, 6}, {0, 0, 0}),
                           cone({0, 9, 0}, 1, 1, 0.5, 24)});
  EXPECT_NEAR(contacts.solids().width(0), 0.2, 1e-12);
  EXPECT_EQ(contacts.solids().width(-1), infinite);
  EXPECT_NEAR(contacts.solids().width(-2), 4, 1e-12);
  EXPECT_NEAR(contacts.solids().width(-3), 0.5, 1e-12);
  EXPECT_NEAR(contacts.solids().thinnest(), 0.2, 1e-12);
}

TEST(ContactStart, DeepOverlapIsRefusedSlightOnesAreSaid) {
  Scene scene = contact_scene(1e8, 0, 1, false);
  const auto said = [&](double overlap) {
    return Asked(scene, two_cubes(overlap)).force().overlap_at_start();
  };
  EXPECT_EQ(said(0.0009), "");
  EXPECT_NE(said(0.0011).find("body 0 and body 1 overlap by 0.0011 m"), std::string::npos);
  EXPECT_NE(said(0.09).find("press apart"), std::string::npos);
  try {
    said(0.11);
    ADD_FAILURE() << "an overlap of 0.11 must be refused";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("0.11"), std::string::npos);
    EXPECT_NE(std::string(error.what()).find("stress_free"), std::string::npos);
  }
  scene.contact.initial_overlap = InitialOverlap::stress_free;
  EXPECT_NE(said(0.3).find("rest"), std::string::npos);
}

/// What overlaps at the start presses with k_v A d, or not at all; pressed on by d' it gives
/// k_v A d' then, and it stays so after the first step.
TEST(ContactStart, StressFreeOverlapIsAtRest) {
  Scene scene = contact_scene(1e8, 0, 1, false);
  for (const ContactLaw law : {ContactLaw::overlap, ContactLaw::potential}) {
    scene.contact.law = law;
    scene.contact.initial_overlap = InitialOverlap::press;
    test::Dynamics pressing(scene, two_cubes(0.05));
    EXPECT_NEAR(pressing.wrenches().of(1)[2], 1e8 * 0.05, 1e-3);

    scene.contact.initial_overlap = InitialOverlap::stress_free;
    Lattice moving = two_cubes(0.05);
    moving.bodies.velocity[1] = {0, 0, -1e-2};
    test::Dynamics resting(scene, moving);
    EXPECT_EQ(resting.wrenches().of(1)[2], 0);
    test::start(resting);
    EXPECT_EQ(resting.wrenches().of(1)[2], 0);
    for (int n = 1; n <= 3; ++n) {
      (void)resting.step();
      const double way = resting.state().record(0)[2] - resting.state().record(1)[2];
      EXPECT_GT(way, 0) << n;
      EXPECT_NEAR(resting.wrenches().of(1)[2], 1e8 * way, 1e-6 * 1e8 * way) << n;
    }
  }
}

TEST(ContactStart, StepIsLimitedBySpeedsAgainstTheLeastWidth) {
  Scene scene = contact_scene(1e8, 0, 1, false);
  Obstacle& plate = test::append_obstacle(scene, "plate", box({0, 0, -5}, {3, 3, 0.05}, {0, 0, 0}));
  Lattice lattice;
  test::append_block(lattice, {1, 1, 1}, {0, 0, 0}, {1, 0, 0, 0}, {0, 0, -50});
  const auto limit = [&] {
    Asked asked(scene, lattice);
    return asked.force().roles().step->step_limit(asked.dynamics.state());
  };
  EXPECT_NEAR(limit().dt, 0.1 * 0.05 / 100, 1e-12);  // two bodies as fast may meet
  EXPECT_NE(limit().reason.find("body 0"), std::string::npos);
  plate.motion.velocity = {0, 0, 300};
  EXPECT_NEAR(limit().dt, 0.1 * 0.05 / 350, 1e-12);
  EXPECT_NE(limit().reason.find("obstacle 'plate'"), std::string::npos);
  lattice.bodies.velocity[0] = {};
  plate.motion = {};
  EXPECT_EQ(limit().dt, infinite);
}

/// A cube of 1 m falls on a plate of 5 cm that is too soft to stop it; a stiff one stops it.
TEST(ContactStart, BodyPressedThroughAPlateIsSaid) {
  for (const double young : {1e6, 1e11}) {
    Scene scene = contact_scene(young, 0, 1, false);
    test::append_obstacle(scene, "plate", box({0, 0, -0.526}, {3, 3, 0.05}, {0, 0, 0}));
    Lattice lattice;
    test::append_block(lattice, {1, 1, 1}, {0, 0, 0}, {1, 0, 0, 0}, {0, 0, -5});
    Asked asked(scene, lattice);
    test::start(asked.dynamics, young < 1e9 ? 0.005 : 0.5);
    std::vector<Remark> remarks;
    while (asked.dynamics.state().time < 0.05) {
      (void)asked.dynamics.step();
      for (const auto& remark : asked.force().roles().remarks->take_remarks())
        remarks.push_back(remark);
    }
    if (young > 1e9) {
      EXPECT_TRUE(remarks.empty());
      EXPECT_NEAR(asked.dynamics.state().record(0)[9], 5, 0.05);
      continue;
    }
    ASSERT_EQ(remarks.size(), 2U);  // later the plate reaches through the cube
    EXPECT_NE(remarks[0].text.find("body 0 is pressed into obstacle 'plate'"), std::string::npos);
    // A quarter of 0.05 m beyond the gap of 1 mm, at 5 m/s.
    EXPECT_NE(remarks[1].text.find("press on each other nowhere"), std::string::npos);
    EXPECT_NEAR(remarks[0].time, (0.001 + 0.0125) / 5, 2e-4);
  }
}

}  // namespace
