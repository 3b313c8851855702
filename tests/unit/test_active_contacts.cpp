// The contacts of an evaluation: they take the memory of earlier ones, but nothing else of them.

#include <gtest/gtest.h>

#include <array>
#include <cstdint>

#include "active_contacts/active_contacts.h"
#include "support/lattices.h"

namespace floe {
namespace {

constexpr std::array<std::int32_t, 1> first_pair{0};

/// A body that lies inside another has no direction and no friction, whatever contact had its place
/// in memory before.
TEST(ActiveContacts, AnEnclosedOneKeepsNoSpringsOfAnother) {
  Lattice lattice = test::row(2);
  ActiveContacts active(0);
  active.start(2);
  ContactBlock& slides = active.add(first_pair, 1);
  slides.trial.normal = {0, 0, 1};
  slides.springs = {.force = {3, 4, 0}, .couple = 5};
  slides.mark(1);
  EXPECT_EQ(active.memory(0).springs.force, (Vec3<double>{3, 4, 0}));

  active.start(2);
  ContactBlock& enclosed = active.add(first_pair, 1);
  enclosed.trial = {};
  enclosed.mark(1);
  ASSERT_TRUE(active.is_enclosed(0));
  const Solids solids(lattice.shapes, lattice.bodies.mass, {});
  const PairList list(solids, {}, false);
  active.act(list, [](const ContactBlock&, auto) { return ContactForceOf<Lanes>{}; });
  EXPECT_EQ(active.memory(0).springs.force, (Vec3<double>{0, 0, 0}));
  EXPECT_EQ(active.memory(0).twist.couple, 0);
}

}  // namespace
}  // namespace floe
