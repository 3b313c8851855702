// Junctions of facets, and which beams are at a crack's tip.
#include "fracture_laws/crack_tips.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <numeric>
#include <optional>
#include <set>
#include <vector>

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

/// Beams at a junction.
std::vector<std::int32_t> beams_at(const Junctions& found, std::int32_t junction) {
  std::vector<std::int32_t> all;
  for (const std::int32_t f : found.at(junction)) all.push_back(item(found.facets, f).beam);
  return all;
}
const std::array<std::int32_t, 2>& ends_of(const Junctions& found, std::int32_t beam) {
  return item(found.facets, item(found.facet_of, beam)).junctions;
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
    const Junctions found = find_junctions(lattice, Shear::one_point);
    EXPECT_EQ(found.size(), lattice.beams.size() - lattice.bodies.size() + 1);
    for (std::int32_t k = 0; k < found.size(); ++k) {
      std::set<std::int32_t> bodies;
      for (const std::int32_t f : found.at(k)) {
        const CrackFacet& facet = item(found.facets, f);
        ASSERT_NE(facet.beam, none);
        const auto [i, j] = item(lattice.beams.bodies, facet.beam);
        EXPECT_EQ(facet.bodies, (std::array{i, j}));
        EXPECT_NEAR(facet.width, item(lattice.beams.width, facet.beam), 1e-6);
        EXPECT_EQ(item(found.facet_of, facet.beam), f);
        bodies.insert({i, j});
      }
      EXPECT_EQ(bodies.size(), 3U);
    }
  }
}

TEST(CrackTips, ABrokenBeamMakesTipsAtBothEndsAndFlanksMakeNone) {
  const Lattice lattice = test::sheet(12, 9, 1);
  const Junctions found = find_junctions(lattice, Shear::one_point);
  const std::int32_t inner = inner_beam(lattice), beams = lattice.beams.size();
  CrackTips cracks(found);
  EXPECT_TRUE(tips(cracks, beams).empty());
  EXPECT_TRUE(cracks.lose(inner));
  EXPECT_FALSE(cracks.lose(inner));
  std::set<std::int32_t> expected;
  for (const std::int32_t junction : ends_of(found, inner)) {
    ASSERT_NE(junction, none);
    for (const std::int32_t beam : beams_at(found, junction)) expected.insert(beam);
  }
  expected.erase(inner);
  EXPECT_EQ(expected.size(), 4U);
  EXPECT_EQ(tips(cracks, beams), expected);
  // The crack goes on at one end: the beam that is left there is on its flank.
  const auto end = beams_at(found, ends_of(found, inner)[0]);
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
  const std::set<std::int32_t> at =
      tips(CrackTips(find_junctions(lattice, Shear::one_point)), lattice.beams.size());
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
  EXPECT_TRUE(
      tips(CrackTips(find_junctions(lattice, Shear::one_point)), lattice.beams.size()).empty());
}

/// A sheet with a cut from its lower side to the middle, and the crack behind a beam at its tip.
struct CutSheet {
  Lattice lattice = test::sheet(12, 9, 1);
  std::optional<CrackTips> tips;
  std::vector<CrackBehind> cracks;

  CutSheet() {
    cut(lattice, {0, -9}, {0, 0});
    tips.emplace(find_junctions(lattice, Shear::one_point));
    cracks = tips->behind(*floe::tips(*tips, lattice.beams.size()).begin());
  }
  /// (pi/32) |c|^2 of a motion that depends on the place, x right of the cut or left of it.
  double opening(const std::function<BodyPose(const Point3&)>& pose, double bent = 1,
                 bool linear = false) const {
    return tips->opening(cracks.front(), bent, linear, [&](std::int32_t body) {
      return pose(item(lattice.bodies.position, body));
    });
  }
};

TEST(CrackTips, ACrackIsFollowedAlongItsFacets) {
  const CutSheet sheet;
  ASSERT_EQ(sheet.cracks.size(), 1U);
  const CrackBehind& crack = sheet.cracks.front();
  EXPECT_EQ(crack.size, CrackBehind::most);
  std::vector<std::int32_t> bodies;
  sheet.tips->append_bodies(sheet.cracks, bodies);
  ASSERT_EQ(bodies.size(), 2 * crack.size);
  for (std::size_t k = 0; k < bodies.size(); k += 2) {
    const double a = item(sheet.lattice.bodies.position, bodies[k]).x,
                 b = item(sheet.lattice.bodies.position, bodies[k + 1]).x;
    EXPECT_LT(a * b, 0) << "one to either side of the cut";
  }
}

/// Faces that open by c sqrt(r) have (pi/32) c^2, where r is the distance from the tip; so the
/// energy release rate pi E c^2/32 is K^2/E by the opening 8 K/E sqrt(r/(2 pi)) of Williams' field.
/// Faces that slide have 4/3 of it: the hoop stress of mode II is 2/sqrt(3) of that of mode I
/// (Erdogan & Sih 1963). Faces that press on each other have none, nor has motion of the sheet as a
/// whole.
TEST(CrackTips, OpeningIsFittedByTheRootOfTheDistance) {
  const CutSheet sheet;
  const Point2 tip = sheet.cracks.front().tip;
  // Bodies beside the cut: their motion at the height of the body, so r is not exact. The sheet
  // as a whole is turned by `turned`.
  const auto apart = [&](const Vec3<double>& c, const Quat<double>& turned) {
    return sheet.opening([&](const Point3& x) {
      const double r = std::hypot(x.x - tip[0], x.y - tip[1]);
      const Vec3<double> moved = x + (x.x > 0 ? 0.5 : -0.5) * std::sqrt(r) * c;
      return BodyPose{rotate(turned, moved) - x, turned};
    }) / (std::numbers::pi / 32 * 4e-8);
  };
  const Quat<double> as_is{1, 0, 0, 0};
  const Vec3<double> across{2e-4, 0, 0}, along{0, 2e-4, 0};
  const double opened = apart(across, as_is), slid = apart(along, as_is);
  EXPECT_NEAR(opened, 1, 0.15);
  EXPECT_NEAR(slid / opened, 4.0 / 3, 0.1);  // the cut runs along y but for its zigzag
  EXPECT_NEAR(apart(-along, as_is) / opened, 4.0 / 3, 0.1);
  EXPECT_LT(apart(-across, as_is), 0.02);
  const Quat<double> turn = exp_rotation({0.3, -0.2, 0.7});
  EXPECT_LT(sheet.opening([&](const Point3& x) {
    return BodyPose{rotate(turn, x) - x + Vec3<double>{3, 2, 1}, turn};
  }),
            1e-28);
  EXPECT_NEAR(apart(across, turn), opened, 1e-9);
  EXPECT_NEAR(apart(along, turn), slid, 1e-9);
}

/// One side may be lifted against the other, however far, also where the sheet lies at a slope:
/// that is no opening.
TEST(CrackTips, FacesThatAreLiftedDoNotOpen) {
  const CutSheet sheet;
  const Quat<double> slope = exp_rotation({0.2, -0.3, 0});
  for (const bool linear : {false, true}) {
    const Quat<double> turn = linear ? Quat<double>{1, 0, 0, 0} : slope;
    const Vec3<double> up = linear ? Vec3<double>{0, 0, 1} : triad(turn).e3;
    EXPECT_LT(sheet.opening(
                  [&](const Point3& x) {
                    const Vec3<double> lifted = (x.x > 0 ? 0.5 : -0.5) * up;
                    return BodyPose{rotate(turn, x) - x + lifted, turn};
                  },
                  1, linear),
              1e-28);
  }
}

/// An inner crack of the length L opens as an ellipse, by c sqrt(r (1 - r/L)) (Griffith 1921), and
/// has the same (pi/32) c^2 whether eight of its facets reach to its other tip or not.
TEST(CrackTips, AnInnerCrackOpensAsAnEllipse) {
  for (const double half : {3.0, 4.0, 8.0}) {
    Lattice lattice = test::sheet(12, 30, 1);
    cut(lattice, {0, -half}, {0, half});
    const CrackTips cracks(find_junctions(lattice, Shear::one_point));
    int ends = 0;
    for (const std::int32_t m : tips(cracks, lattice.beams.size())) {
      const std::vector<CrackBehind> behind = cracks.behind(m);
      ASSERT_EQ(behind.size(), 1U);
      const CrackBehind& crack = behind.front();
      EXPECT_NEAR(crack.length, 2 * half, 1.5);
      const Vec3<double> c{2e-4, 0, 0};
      const double fitted = cracks.opening(crack, 1, false, [&](std::int32_t body) {
        const Point3& x = item(lattice.bodies.position, body);
        const double r = std::hypot(x.x - crack.tip[0], x.y - crack.tip[1]);
        const double shape = std::sqrt(r * std::max(0.0, 1 - r / crack.length));
        return BodyPose{(x.x > 0 ? 0.5 : -0.5) * shape * c, {1, 0, 0, 0}};
      });
      EXPECT_NEAR(fitted / (std::numbers::pi / 32 * 4e-8), 1, 0.15) << half;
      ++ends;
    }
    EXPECT_GE(ends, 2);
  }
}

/// Faces that turn against each other count by the given weight. A turn about the vertical is none
/// of theirs.
TEST(CrackTips, FacesThatBendApartCountByTheirTurn) {
  const CutSheet sheet;
  const auto turned = [&](const Vec3<double>& psi, double bent, bool linear) {
    return sheet.opening(
        [&](const Point3& x) {
          const Vec3<double> half = (x.x > 0 ? 0.5 : -0.5) * psi;
          const Quat<double> q = linear ? Quat<double>{1, 0.5 * half.x, 0.5 * half.y, 0.5 * half.z}
                                        : exp_rotation(half);
          return BodyPose{{0, 0, 0}, q};
        },
        bent, linear);
  };
  const Vec3<double> bend{0, 1e-3, 0}, yaw{0, 0, 1e-3};
  for (const bool linear : {false, true}) {
    const double faces = turned(bend, 1, linear) - turned(bend, 0, linear);
    EXPECT_NEAR((turned(bend, 3, linear) - turned(bend, 0, linear)) / faces, 3, 1e-9);
    // c = psi sum(w sqrt(r))/sum(w r), and facets lie between 0 and about 5 m from the tip
    EXPECT_GT(faces, std::numbers::pi / 32 * 1e-6 / 5);
    EXPECT_LT(faces, std::numbers::pi / 32 * 1e-6);
    EXPECT_EQ(turned(yaw, 1, linear), turned(yaw, 3, linear));
  }
}

/// Short spurs, as a saw leaves them where it turns at a corner, are not followed round the corner.
TEST(CrackTips, ABlockCutOutHasNoCracksBehindItsTips) {
  Lattice lattice = test::sheet(20, 20, 1);
  const std::array<Point2, 5> corners{{{-4, -4}, {4, -4}, {4, 4}, {-4, 4}, {-4, -4}}};
  for (std::size_t k = 0; k < 4; ++k) cut(lattice, corners[k], corners[k + 1]);
  const CrackTips cracks(find_junctions(lattice, Shear::one_point));
  for (const std::int32_t m : tips(cracks, lattice.beams.size()))
    EXPECT_TRUE(cracks.behind(m).empty());
}

/// Unit cubes in a rectangle, a beam per common face but those between rows 0 and 1 of the columns
/// below `cut`; only what junctions are found from.
Lattice squares(std::int32_t columns, std::int32_t rows, std::int32_t cut) {
  Lattice lattice;
  lattice.shapes.vertex_of = {0};
  const auto join = [&](std::int32_t a, std::int32_t b) {
    lattice.beams.bodies.push_back({a, b});
    lattice.beams.length.push_back(1);
  };
  for (std::int32_t k = 0; k < rows * columns; ++k) {
    const std::int32_t x = k % columns, y = k / columns;
    lattice.bodies.position.push_back({double(x), double(y), 0});
    lattice.bodies.orientation.push_back({1, 0, 0, 0});
    for (const int v : {0, 1, 2, 3, 4, 5, 6, 7})
      lattice.shapes.vertices.push_back({v % 2 - 0.5, v / 2 % 2 - 0.5, v / 4 - 0.5});
    lattice.shapes.vertex_of.push_back(static_cast<std::int32_t>(lattice.shapes.vertices.size()));
    lattice.shapes.face_of.push_back(0);  // no faces are looked at
    if (x + 1 < columns) join(k, k + 1);
    if (y + 1 < rows && !(y == 0 && x < cut)) join(k, k + columns);
  }
  return lattice;
}

/// The largest hoop stress of modes I and II of one intensity over that of mode I, by search.
double hoop_of_both() {
  double most = 0;
  for (int k = -100000; k <= 100000; ++k) {
    const double t = std::numbers::pi / 2 * k / 100000, c = std::cos(t / 2);
    most = std::max(most, c * (c * c - 1.5 * std::sin(t)));
  }
  return most;
}

/// Where cells are mirrored at a cut four facets meet: a straight cut has flanks and one tip.
TEST(CrackTips, FourFacetsMayMeet) {
  const Lattice lattice = squares(8, 3, 5);
  const Junctions found = find_junctions(lattice, Shear::one_point);
  ASSERT_EQ(found.size(), 7 * 2);
  for (std::int32_t k = 0; k < found.size(); ++k) EXPECT_EQ(found.at(k).size(), 4U);
  const CrackTips cracks(found);
  const std::set<std::int32_t> at = tips(cracks, lattice.beams.size());
  EXPECT_EQ(at.size(), 3U);  // ahead of the cut and to both sides of its end
  for (const std::int32_t beam : at) {
    const std::vector<CrackBehind> behind = cracks.behind(beam);
    ASSERT_EQ(behind.size(), 1U);
    EXPECT_EQ(behind[0].size, 5U);
    EXPECT_EQ(behind[0].tip, (Point2{4.5, 0.5}));
    // Faces apart by c sqrt(r) + b r sqrt(r) at middles r = 0.5, 1.5, ... from the tip: of K only
    // c tells, whatever the stress along the crack. k1, k2: parts of c that open and that slide
    const auto opening = [&](double k1, double k2, double b) {
      return cracks.opening(behind[0], 0, true, [&](std::int32_t body) {
        const double r = 4.5 - body % 8, root = body < 8 ? 0 : std::sqrt(r);
        return BodyPose{{(k2 + b * r) * root, (k1 + b * r) * root, 0}, {1, 0, 0, 0}};
      }) / (std::numbers::pi / 32);
    };
    for (const double b : {0.0, 1e-4, -3e-4}) {
      EXPECT_NEAR(opening(2e-4, 0, b) / 4e-8, 1, 1e-11);
      EXPECT_NEAR(opening(0, 2e-4, b) / 4e-8, 4.0 / 3, 1e-11);
      EXPECT_NEAR(opening(-2e-4, 2e-4, b) / 4e-8, 4.0 / 3, 1e-11) << "pressed faces";
      EXPECT_NEAR(std::sqrt(opening(2e-4, 2e-4, b)) / 2e-4, hoop_of_both(), 1e-9);
      EXPECT_NEAR(std::sqrt(opening(2e-4, -2e-4, b)) / 2e-4, hoop_of_both(), 1e-9);
    }
  }
}

TEST(CrackTips, ALatticeWithoutShapesIsRefused) {
  Lattice lattice = test::sheet(6, 6, 1);
  lattice.shapes = {};
  EXPECT_THROW((void)find_junctions(lattice, Shear::one_point), InputError);
}

}  // namespace
}  // namespace floe
