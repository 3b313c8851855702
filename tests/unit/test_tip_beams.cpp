// Beams at the tips of a cut: their strengths, their overloads, and those that break there.
#include "fracture_laws/tip_beams.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <set>
#include <vector>

#include "floe/base/item.h"
#include "floe/base/petsc.h"
#include "fracture_laws/strengths.h"
#include "support/lattices.h"

namespace floe {
namespace {

/// A sheet with a cut from its lower side to the middle, on one rank: local beams are global.
struct CutSheet {
  Lattice lattice = cut_lattice();
  Part part = partition(lattice, PETSC_COMM_SELF);
  FractureOptions options;
  CrackTips cracks{find_junctions(lattice, Shear::one_point)};
  TipBeams tips{part, options, false, find_junctions(lattice, Shear::one_point)};
  std::vector<std::int32_t> at;  ///< beams at the tip

  CutSheet() {
    for (std::int32_t m = 0; m < part.beams.size(); ++m) {
      if (cracks.is_tip(m)) at.push_back(m);
    }
  }
  static Lattice cut_lattice() {
    Lattice sheet = test::sheet(12, 9, 1);
    cut(sheet, {0, -9}, {0, 0});
    return sheet;
  }
  /// Whether the tip weakens beams that are far stronger elsewhere.
  std::set<std::int32_t> weakened() const {
    std::set<std::int32_t> all;
    for (std::int32_t m = 0; m < part.beams.size(); ++m) {
      if (tips.weakens(m, scaled(m, 1e-3))) all.insert(m);
    }
    return all;
  }
  /// Strength of a beam at a tip with all factors times `factor`: below 1 it is stronger.
  Strength<double> scaled(std::int32_t m, double factor) const {
    Strength<double> s = tip_strength(part, m, options);
    for (double* f : {&s.axial, &s.bending_y, &s.bending_z, &s.shear, &s.torsion}) *f *= factor;
    return s;
  }
  /// The faces of the cut apart by `width` times the root of the distance from the middle.
  State<Spatial> opened(double width) const {
    State<Spatial> state(static_cast<std::size_t>(part.local));
    for (std::size_t b = 0; b < static_cast<std::size_t>(part.local); ++b) {
      const Point3& x = part.bodies.position[b];
      state.record(b)[0] = (x.x > 0 ? 0.5 : -0.5) * width * std::sqrt(std::hypot(x.x, x.y));
    }
    return state;
  }
  /// sqrt(G/G_f) of the crack behind a beam.
  double open_overload(std::int32_t m, const State<Spatial>& state) const {
    const double g = cracks.opening(cracks.behind(m).front(), 0, false, [&](std::int32_t body) {
      return BodyPose{displacement(state, static_cast<std::size_t>(body)), {1, 0, 0, 0}};
    });
    const double young = cracks.junctions().moduli.young * item(part.beams.young, m);
    return std::sqrt(young * g / options.energy);
  }
};

TEST(TipBeams, OnlyBeamsThatAreStrongerElsewhereAreWeakened) {
  const CutSheet sheet;
  ASSERT_EQ(sheet.at.size(), 2U);
  EXPECT_EQ(sheet.weakened(), std::set<std::int32_t>(sheet.at.begin(), sheet.at.end()));
  for (const std::int32_t m : sheet.at) {
    EXPECT_TRUE(sheet.tips.weakens(m, sheet.scaled(m, 0.99)));
    EXPECT_FALSE(sheet.tips.weakens(m, sheet.scaled(m, 1.01)));
  }
}

/// s of the strengths by which a tip beam is looked at is 1 where s_t is armed_from, under each
/// section force alone, and never below s at initiation.
TEST(TipBeams, AreLookedAtFromHalfTheirStrengthOn) {
  const CutSheet sheet;
  const std::int32_t m = sheet.at.front();
  const Strength<double> tip = tip_strength(sheet.part, m, sheet.options);
  const FurtherStrength<double> further{2, 0.3, 0.4};
  const TipBeams::Strengths strong = sheet.tips.armed(m, {sheet.scaled(m, 1e-3), further});
  const TipBeams::Strengths weak = sheet.tips.armed(m, {sheet.scaled(m, 3), further});
  for (int k = 0; k < 6; ++k) {
    BeamStress<double> force{0, 0, 0, {0, 0, 0}};
    double* const of[] = {&force.n, &force.qy, &force.qz, &force.c.x, &force.c.y, &force.c.z};
    *of[k] = 1e4;
    const double s_t = std::sqrt(criterion(tip, force));
    *of[k] *= TipBeams::armed_from / s_t;
    EXPECT_NEAR(criterion(strong.first, force), 1, 1e-12) << k;
    EXPECT_NEAR(criterion(weak.first, force), 9.0 / 4, 1e-12) << k;  // 3 s_t
  }
  // Axis 3: whichever of the strength at a tip and the weighted one at initiation is worse.
  EXPECT_NEAR(strong.further.transverse, 1, 1e-12);
  EXPECT_NEAR(weak.further.transverse, 2, 1e-12);
  EXPECT_EQ(weak.further.pressure, 0.3);
  EXPECT_EQ(weak.further.friction, 0);
}

/// s^2 = s_o min(s_o, s_t).
TEST(TipBeams, OverloadIsByTheOpeningAndAtMostByTheStress) {
  const CutSheet sheet;
  const std::int32_t m = sheet.at.front();
  const double once = sheet.open_overload(m, sheet.opened(1e-5));
  ASSERT_GT(once, 0);
  const State<Spatial> state = sheet.opened(2e-5 / once);  // s_o is linear in the width: 2
  ASSERT_NEAR(sheet.open_overload(m, state), 2, 1e-9);
  const auto overload = [&](double s_t) {
    const std::vector<TipOverload> all = sheet.tips.overloads({{s_t, m}}, state);
    EXPECT_EQ(all.size(), 1U);
    EXPECT_EQ(overload_of(m + 1, all), 0);
    return overload_of(m, all);
  };
  EXPECT_NEAR(overload(0.5), 1, 1e-9);
  EXPECT_NEAR(overload(1.5), std::sqrt(3.0), 1e-9);
  EXPECT_NEAR(overload(5), 2, 1e-9);
  EXPECT_TRUE(sheet.tips.overloads({}, state).empty());
}

/// Statics: a broken beam moves the tip, and retreat() moves it back unless keep() came between.
TEST(TipBeams, RetreatGoesBackToWhatWasKept) {
  CutSheet sheet;
  const std::set<std::int32_t> before = sheet.weakened();
  const TipBeams::Change change = sheet.tips.lose(sheet.at.front());
  const std::set<std::int32_t> after = sheet.weakened();
  EXPECT_NE(after, before);
  EXPECT_EQ(after.count(sheet.at.front()), 0U);
  for (const auto& [some, others] : {std::pair(&before, &after), std::pair(&after, &before)}) {
    for (const std::int32_t m : *some) {
      if (others->count(m) != 0) continue;
      EXPECT_NE(std::count(change.strengths.begin(), change.strengths.end(), m), 0) << m;
    }
  }
  EXPECT_TRUE(sheet.tips.lose(sheet.at.front()).strengths.empty()) << "it is gone already";
  sheet.tips.retreat();
  EXPECT_EQ(sheet.weakened(), before);
  (void)sheet.tips.lose(sheet.at.front());
  sheet.tips.keep();
  sheet.tips.retreat();
  EXPECT_EQ(sheet.weakened(), after);
}

/// Dynamics: of two overloaded beams at one tip the worse breaks in the next evaluation; the other
/// one is then beside the crack.
TEST(TipBeams, TheMostOverloadedBeamIsDoomedForOneStep) {
  CutSheet sheet;
  const std::int32_t a = sheet.at[0], b = sheet.at[1];
  const State<Spatial> state = sheet.opened(3e-5 / sheet.open_overload(a, sheet.opened(1e-5)));
  const TipBeams::Change change = sheet.tips.propagate({}, {{1.0, a}, {2.0, b}}, state);
  EXPECT_EQ(change.doomed, std::vector<std::int32_t>{b});
  EXPECT_TRUE(sheet.tips.is_doomed(b));
  EXPECT_FALSE(sheet.tips.is_doomed(a));
  EXPECT_EQ(sheet.weakened().count(a), 0U);
  EXPECT_EQ(sheet.tips.propagate({b}, {}, state).doomed, std::vector<std::int32_t>{b});  // no more
  EXPECT_FALSE(sheet.tips.is_doomed(b));
}

}  // namespace
}  // namespace floe
