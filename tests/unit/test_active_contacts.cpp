// The contacts of an evaluation: they take the memory of earlier ones, but nothing else of them.

#include <gtest/gtest.h>

#include "active_contacts/active_contacts.h"
#include "support/lattices.h"

namespace floe {
namespace {

/// A body that lies inside another has no direction and no friction, whatever contact had its place
/// in memory before.
TEST(ActiveContacts, AnEnclosedOneKeepsNoSpringsOfAnother) {
  Lattice lattice = test::row(2);
  ActiveContacts active(0);
  active.start(2);
  ActiveContact& slides = active.add(true);
  slides.trial.normal = {0, 0, 1};
  slides.springs = {.force = {3, 4, 0}, .couple = 5};
  EXPECT_EQ(slides.memory().springs.force, (Vec3<double>{3, 4, 0}));

  active.start(2);
  ActiveContact& enclosed = active.add(true);
  enclosed.trial = {};
  ASSERT_TRUE(enclosed.is_enclosed());
  const Solids solids(lattice.shapes, lattice.bodies.mass, {});
  const PairList list(solids, {}, false);
  active.act(list, Places(0), [](const ActiveContact&, const Pair&) { return ContactForce{}; });
  EXPECT_EQ(active.contacts().front().memory().springs.force, (Vec3<double>{0, 0, 0}));
  EXPECT_EQ(active.contacts().front().memory().twist.couple, 0);
}

}  // namespace
}  // namespace floe
