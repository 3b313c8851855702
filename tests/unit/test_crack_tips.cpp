// Junctions of facets, and which beams are at a crack's tip.
#include "fracture/crack_tips.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <set>

#include "floe/base/item.h"
#include "floe/base/petsc.h"
#include "support/lattices.h"

namespace floe {
namespace {

constexpr std::int32_t none = Junctions::none;

/// Beams at a tip.
std::set<std::int32_t> tips(const CrackTips& cracks, std::int32_t beams) {
  std::set<std::int32_t> all;
  for (std::int32_t m = 0; m < beams; ++m) {
    if (cracks.is_tip(m)) all.insert(m);
  }
  return all;
}

/// Beam of a sheet that is farthest from its sides.
std::int32_t inner_beam(const Lattice& lattice) {
  std::int32_t inner = 0;
  double nearest = 1e9;
  for (std::int32_t m = 0; m < lattice.beams.size(); ++m) {
    const auto [i, j] = item(lattice.beams.bodies, m);
    const Point3 middle =
        0.5 * (item(lattice.bodies.position, i) + item(lattice.bodies.position, j));
    if (const double r = std::hypot(middle.x, middle.y); r < nearest) nearest = r, inner = m;
  }
  return inner;
}

/// Each junction joins three beams in a ring of three bodies; by Euler's formula for a plane graph
/// a simply connected sheet of n cells with m facets has m - n + 1 of them.
TEST(CrackTips, JunctionsOfASheetAreThoseOfItsPlaneGraph) {
  Lattice lattice = test::sheet(12, 9, 1);
  for (const bool reordered : {false, true}) {
    if (reordered) reorder(lattice);
    const Junctions found = find_junctions(lattice);
    EXPECT_EQ(found.beams.size(),
              static_cast<std::size_t>(lattice.beams.size() - lattice.bodies.size() + 1));
    for (const auto& facets : found.beams) {
      std::set<std::int32_t> bodies;
      for (const std::int32_t m : facets) {
        ASSERT_NE(m, none);
        const auto [i, j] = item(lattice.beams.bodies, m);
        bodies.insert({i, j});
      }
      EXPECT_EQ(bodies.size(), 3U);
    }
  }
}

TEST(CrackTips, ABrokenBeamMakesTipsAtBothEndsAndFlanksMakeNone) {
  const Lattice lattice = test::sheet(12, 9, 1);
  const Junctions found = find_junctions(lattice);
  const std::int32_t inner = inner_beam(lattice), beams = lattice.beams.size();
  CrackTips cracks(found);
  EXPECT_TRUE(tips(cracks, beams).empty());
  EXPECT_TRUE(cracks.lose(inner));
  EXPECT_FALSE(cracks.lose(inner));
  std::set<std::int32_t> expected;
  for (const std::int32_t junction : item(found.of_beam, inner)) {
    ASSERT_NE(junction, none);
    expected.insert(item(found.beams, junction).begin(), item(found.beams, junction).end());
  }
  expected.erase(inner);
  EXPECT_EQ(expected.size(), 4U);
  EXPECT_EQ(tips(cracks, beams), expected);
  // The crack goes on at one end: the beam that is left there is on its flank.
  const auto& end = item(found.beams, item(found.of_beam, inner)[0]);
  std::int32_t next = end[0] != inner ? end[0] : end[1];
  const std::int32_t left = std::accumulate(end.begin(), end.end(), 0) - inner - next;
  (void)cracks.lose(next);
  EXPECT_FALSE(cracks.is_tip(left));
  EXPECT_FALSE(cracks.is_tip(next));
  EXPECT_EQ(tips(cracks, beams).size(), 4U);  // two at either end
  cracks.reset();
  EXPECT_TRUE(tips(cracks, beams).empty());
}

/// A cut of the saw has two flanks, and a tip where it ends inside the sheet.
TEST(CrackTips, ACutHasATipAtItsEndOnly) {
  Lattice lattice = test::sheet(12, 9, 1);
  cut(lattice, {0, -9}, {0, 0});
  const std::set<std::int32_t> at = tips(CrackTips(find_junctions(lattice)), lattice.beams.size());
  EXPECT_EQ(at.size(), 2U);
  for (const std::int32_t m : at) {
    const auto [i, j] = item(lattice.beams.bodies, m);
    EXPECT_LT(std::hypot(item(lattice.bodies.position, i).x, item(lattice.bodies.position, i).y),
              2);
    EXPECT_LT(std::hypot(item(lattice.bodies.position, j).x, item(lattice.bodies.position, j).y),
              2);
  }
  // All through the sheet: no tip is left.
  cut(lattice, {0, -9}, {0, 9});
  EXPECT_TRUE(tips(CrackTips(find_junctions(lattice)), lattice.beams.size()).empty());
}

TEST(CrackTips, ALatticeWithoutShapesIsRefused) {
  Lattice lattice = test::sheet(6, 6, 1);
  lattice.shapes = {};
  EXPECT_THROW((void)find_junctions(lattice), InputError);
}

}  // namespace
}  // namespace floe
