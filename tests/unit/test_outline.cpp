// Sheets of any outline: the cells end exactly on it, cover it and do not overlap.
#include "floe/mesh/outline.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "floe/base/petsc.h"
#include "floe/geometry/polyhedron.h"
#include "floe/lattice/lattice.h"
#include "floe/mesh/cuts.h"
#include "scene/outline_file.h"

namespace floe {
namespace {

Ring box(double x0, double x1, double y0, double y1) {
  return {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}};
}

Ring circle(double radius, int corners, const Point2& centre = {0, 0}) {
  Ring ring;
  for (int k = 0; k < corners; ++k) {
    const double a = 2 * std::numbers::pi * k / corners;
    ring.push_back({centre[0] + radius * std::cos(a), centre[1] + radius * std::sin(a)});
  }
  return ring;
}

Ring turned(Ring ring, double degrees) {
  const double a = degrees * std::numbers::pi / 180;
  for (Point2& p : ring)
    p = {std::cos(a) * p[0] - std::sin(a) * p[1], std::sin(a) * p[0] + std::cos(a) * p[1]};
  return ring;
}

SheetPlan plan_of(Outline outline, double l, std::uint64_t seed = 1) {
  SheetPlan plan;
  const auto [least, most] = outline.box();
  plan.length = most[0] - least[0], plan.width = most[1] - least[1];
  plan.element_size = l, plan.seed = seed, plan.iterations = 50;
  plan.outline = std::move(outline);
  return plan;
}

OutlinedCells meshed(const SheetPlan& plan, const std::vector<CutLine>& cuts = {}) {
  std::vector<Tessellation> relaxed;
  for (const MeshedBox& b : meshed_boxes(plan))
    relaxed.push_back(tessellate(b.plan, MPI_COMM_SELF));
  return fit_to_outline(plan, std::move(relaxed), cuts, MPI_COMM_SELF);
}

std::span<const Point2> polygon(const Tessellation& t, std::size_t k) {
  return std::span(t.vertices).subspan(t.offset[k], t.offset[k + 1] - t.offset[k]);
}

double perimeter(const Outline& outline) {
  double sum = 0;
  for (const RingedPolygon& p : outline.polygons())
    for (const Ring& ring : p)
      for (std::size_t k = 0; k < ring.size(); ++k) {
        const Point2 &a = ring[k], &b = ring[(k + 1) % ring.size()];
        sum += std::hypot(b[0] - a[0], b[1] - a[1]);
      }
  return sum;
}

/// Cells are convex; all their edges are facets of two of them or lie on the outline, which these
/// cover; their areas sum to the outline's. So there is no gap, and none overlap.
void expect_tiles(const SheetPlan& plan, const Tessellation& t) {
  const Outline& outline = plan.outline;
  const double l = plan.element_size, n = static_cast<double>(t.generators.size());
  double area = 0, around = 0, inner = 0, smallest = 1e300;
  ASSERT_EQ(t.offset.size(), t.generators.size() + 1);
  for (std::size_t k = 0; k < t.generators.size(); ++k) {
    const auto cell = polygon(t, k);
    ASSERT_GE(cell.size(), 3U);
    for (std::size_t i = 0; i < cell.size(); ++i) {
      const Point2 &a = cell[i], &b = cell[(i + 1) % cell.size()], &c = cell[(i + 2) % cell.size()];
      EXPECT_GE((b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0]), -1e-9 * l * l);
      EXPECT_LT(outline.contains(a) ? 0 : outline.distance(a), 1e-9 * l);
    }
    const double own = plan_properties(cell).area;
    smallest = std::min(smallest, own);
    area += own;
  }
  EXPECT_NEAR(area / outline.area(), 1, 1e-12);
  EXPECT_GT(smallest, 0.03 * outline.area() / n);
  for (const auto& [cell, from, to] : boundary_edges(t)) {
    const Point2 middle{(from[0] + to[0]) / 2, (from[1] + to[1]) / 2};
    EXPECT_LT(outline.distance(from), 1e-9 * l);
    EXPECT_LT(outline.distance(middle), 1e-9 * l);
    EXPECT_LT(outline.distance(to), 1e-9 * l);
    EXPECT_NE(t.sides[static_cast<std::size_t>(cell)], 0);
    around += std::hypot(to[0] - from[0], to[1] - from[1]);
  }
  EXPECT_NEAR(around / perimeter(outline), 1, 1e-9);
  for (const Facet& facet : t.facets) {
    EXPECT_LT(facet.cells[0], facet.cells[1]);
    inner += facet.width;
  }
  EXPECT_TRUE(std::is_sorted(t.facets.begin(), t.facets.end(),
                             [](const Facet& a, const Facet& b) { return a.cells < b.cells; }));
  double all = 0;  // of all cells' edges
  for (std::size_t k = 0; k < t.generators.size(); ++k) {
    const auto cell = polygon(t, k);
    for (std::size_t i = 0; i < cell.size(); ++i) {
      const Point2 &a = cell[i], &b = cell[(i + 1) % cell.size()];
      all += std::hypot(b[0] - a[0], b[1] - a[1]);
    }
  }
  EXPECT_NEAR((2 * inner + around) / all, 1, 1e-9);
}

void expect_meshed(const SheetPlan& plan) {
  ASSERT_EQ(plan.outline.flaw(), "");
  const OutlinedCells made = meshed(plan);
  ASSERT_TRUE(made.unfollowed.empty())
      << made.unfollowed.front().line.from[0] << " " << made.unfollowed.front().line.from[1];
  expect_tiles(plan, made.cells);
}

std::vector<Outline> real_floes(const std::string& file) {
  std::ifstream stream(file);
  std::ostringstream text;
  text << stream.rdbuf();
  std::vector<Outline> floes;
  for (const auto& feature : parse_outline(text.str(), file)) floes.emplace_back(feature.polygons);
  return floes;
}

TEST(Outline, RectanglesThatTurn) {
  for (const double degrees : {0, 10, 45, 77, 90}) {
    SCOPED_TRACE(degrees);
    expect_meshed(plan_of(Outline({{turned(box(-9, 9, -4, 4), degrees)}}), 1));
  }
}

TEST(Outline, ConcaveShapes) {
  const Ring bay{{0, 0}, {12, 0}, {12, 10}, {7, 10}, {7, 4}, {5, 4}, {5, 10}, {0, 10}};
  expect_meshed(plan_of(Outline({{bay}}), 1));
  const Ring star{{10, 0}, {3, 3}, {0, 10}, {-3, 3}, {-10, 0}, {-3, -3}, {0, -10}, {3, -3}};
  expect_meshed(plan_of(Outline({{star}}), 1, 3));
}

TEST(Outline, AnnulusWithEdgesNearTheElementSize) {
  expect_meshed(plan_of(Outline({{circle(12, 60), circle(5, 24)}}), 1));
}

TEST(Outline, CirclesOfManyElementSizes) {
  for (const double l : {0.8, 1.0, 1.4}) {
    SCOPED_TRACE(l);
    expect_meshed(plan_of(Outline({{circle(10, 64)}}), l));
  }
}

TEST(Outline, ANeckNarrowerThanTheElementSize) {
  const auto hourglass = [](double neck) {
    return Outline({{Ring{{-8, -4},
                          {-1, -neck / 2},
                          {1, -neck / 2},
                          {8, -4},
                          {8, 4},
                          {1, neck / 2},
                          {-1, neck / 2},
                          {-8, 4}}}});
  };
  expect_meshed(plan_of(hourglass(0.8), 1));
  const OutlinedCells made = meshed(plan_of(hourglass(0.1), 1));
  ASSERT_FALSE(made.unfollowed.empty());
  EXPECT_LT(std::abs(made.unfollowed.front().line.from[1]), 4.1);
  EXPECT_TRUE(made.cells.generators.empty());
}

TEST(Outline, PolygonsThatTouchHaveNoBeamsBetweenThem) {
  const SheetPlan plan = plan_of(Outline({{box(-6, 0, -3, 3)}, {box(0, 6, -3, 3)}}), 1);
  ASSERT_EQ(plan.outline.flaw(), "");
  const OutlinedCells made = meshed(plan);
  ASSERT_TRUE(made.unfollowed.empty());
  double area = 0;
  for (std::size_t k = 0; k < made.cells.generators.size(); ++k)
    area += plan_properties(polygon(made.cells, k)).area;
  EXPECT_NEAR(area / 72, 1, 1e-12);
  for (const Facet& facet : made.cells.facets) {
    const auto [a, b] = facet.cells;
    EXPECT_EQ(made.cells.generators[static_cast<std::size_t>(a)][0] < 0,
              made.cells.generators[static_cast<std::size_t>(b)][0] < 0);
  }
}

TEST(Outline, RealFloes) {
  for (const Outline& floe : real_floes(FLOE_TEST_DATA "/floes.geojson")) {
    ASSERT_EQ(floe.flaw(), "");
    const double l = std::sqrt(floe.area() / 60);
    const auto [outline, moved] = simplified(floe, l / 2);
    EXPECT_GT(moved, 0);
    EXPECT_LT(moved / floe.area(), 0.1);
    EXPECT_NEAR(outline.area() / floe.area(), 1, 1e-12);
    const SimplifiedOutline shrunk = simplified(floe, l / 2, Areas::changed);
    EXPECT_LT(shrunk.outline.area(), 0.99 * floe.area());  // most corners of a floe stick out
    EXPECT_LT(moved, 0.7 * shrunk.moved);
    EXPECT_LT(outline.corners(), floe.corners());
    for (const Ring& ring : floe.polygons().front())
      for (const Point2& p : ring) EXPECT_LE(outline.distance(p), l / 2 * (1 + 1e-12));
    expect_meshed(plan_of(outline, l));
  }
}

TEST(Outline, WhetherEdgesCanBeFollowedIsKnownBeforeMeshing) {
  int with_room = 0, without = 0;
  for (const Outline& floe : real_floes(FLOE_TEST_DATA "/floes.geojson")) {
    const double l = std::sqrt(floe.area() / 60);
    for (const double tolerance : {0.05, 0.1, 0.2, 0.4}) {
      const SheetPlan plan = plan_of(simplified(floe, tolerance * l).outline, l);
      const bool room = can_be_followed(plan.outline.polygons().front(), plan);
      EXPECT_EQ(room, meshed(plan).unfollowed.empty()) << tolerance;
      ++(room ? with_room : without);
    }
  }
  EXPECT_GT(with_room, 0);
  EXPECT_GT(without, 0);
}

TEST(Outline, SmallConvexPolygonsAreOneCell) {
  const Ring small = turned({{0, 0}, {1.4, 0}, {1.5, 0.7}, {0.1, 0.8}}, 20);
  EXPECT_TRUE(is_one_cell({small}, 1));
  EXPECT_FALSE(is_one_cell({small}, 0.8));                                   // too large
  EXPECT_FALSE(is_one_cell({box(0, 3, 0, 0.3)}, 1));                         // too long
  EXPECT_FALSE(is_one_cell({circle(0.6, 13)}, 1));                           // of too many corners
  EXPECT_FALSE(is_one_cell({{{0, 0}, {1, 0}, {0.2, 0.2}, {0, 1}}}, 1));      // not convex
  EXPECT_FALSE(is_one_cell({box(0, 1, 0, 1), box(0.4, 0.6, 0.4, 0.6)}, 1));  // with a hole
  const SheetPlan plan = plan_of(Outline({{small}, {box(4, 8, 0, 3)}, {turned(small, 90)}}), 1);
  const OutlinedCells made = meshed(plan);
  const Tessellation& t = made.cells;
  ASSERT_EQ(made.polygon.size(), t.generators.size());
  EXPECT_EQ(std::count(made.polygon.begin(), made.polygon.end(), 0), 1);
  EXPECT_GT(std::count(made.polygon.begin(), made.polygon.end(), 1), 10);
  EXPECT_EQ(std::count(made.polygon.begin(), made.polygon.end(), 2), 1);
  EXPECT_EQ(polygon(t, 0).size(), 4U);
  EXPECT_EQ(t.sides[0], side_left | side_right | side_bottom | side_top);
  expect_tiles(plan, t);
}

TEST(Outline, SlenderConvexPolygonsAreCellsInARow) {
  const Ring needle{{0, 0}, {6, 0.4}, {6.1, 1.2}};  // rows of cells find no room at its tip
  for (const auto& [scale, number] : {std::pair{0.7, 1}, {1.0, 2}, {2.0, 7}}) {
    SCOPED_TRACE(scale);
    Ring ring = turned(needle, 50 * scale);
    for (Point2& p : ring) p = {scale * p[0], scale * p[1]};
    const SheetPlan plan = plan_of(Outline({{ring}}), 1);
    EXPECT_FALSE(can_be_followed({ring}, plan));
    EXPECT_EQ(cells_in_a_row({ring}, plan), number);
    const OutlinedCells made = meshed(plan);
    EXPECT_TRUE(made.unfollowed.empty());
    ASSERT_EQ(made.cells.generators.size(), static_cast<std::size_t>(number));
    EXPECT_EQ(made.cells.facets.size(), static_cast<std::size_t>(number) - 1);
    expect_tiles(plan, made.cells);
    for (std::size_t k = 0; k < made.cells.generators.size(); ++k)
      EXPECT_NEAR(plan_properties(polygon(made.cells, k)).area / plan.outline.area(), 1.0 / number,
                  1e-9);
  }
  Ring large = needle;
  for (Point2& p : large) p = {4 * p[0], 4 * p[1]};
  EXPECT_EQ(cells_in_a_row({large}, plan_of(Outline({{large}}), 1)), 0);
  EXPECT_EQ(cells_in_a_row({box(0, 4, 0, 4)}, plan_of(Outline({{box(0, 4, 0, 4)}}), 1)), 0);
}

TEST(Outline, FloesOfOneSizeHaveCellsOfTheirOwn) {
  std::vector<RingedPolygon> polygons;
  for (int k = 0; k < 5; ++k) polygons.push_back({box(20 * k, 20 * k + 10, 0, 7)});
  const SheetPlan plan = plan_of(Outline(polygons), 1);
  const OutlinedCells made = meshed(plan);
  expect_tiles(plan, made.cells);
  std::vector<std::vector<double>> areas(5);
  for (std::size_t k = 0; k < made.polygon.size(); ++k)
    areas[static_cast<std::size_t>(made.polygon[k])].push_back(
        plan_properties(polygon(made.cells, k)).area);
  for (int k = 1; k < 4; ++k) EXPECT_NE(areas[0], areas[static_cast<std::size_t>(k)]);
  EXPECT_EQ(areas[0].size(), areas[4].size());  // the first once more
}

TEST(Outline, SidesAreThoseOfTheNormals) {
  const OutlinedCells made = meshed(plan_of(Outline({{box(-6, 6, -4, 4), box(-2, 2, -1, 1)}}), 1));
  const Tessellation& t = made.cells;
  std::array<double, 4> length{};
  for (const auto& [cell, from, to] : boundary_edges(t)) {
    const double nx = to[1] - from[1], ny = from[0] - to[0];  // outwards, the cell is to the left
    const int side = std::abs(nx) > std::abs(ny) ? (nx < 0 ? 0 : 1) : (ny < 0 ? 2 : 3);
    EXPECT_NE(t.sides[static_cast<std::size_t>(cell)] & (1 << side), 0);
    length[static_cast<std::size_t>(side)] += std::hypot(nx, ny);
  }
  // The hole's right rim looks to the left.
  for (const auto& [side, expected] : {std::pair{0, 10.0}, {1, 10.0}, {2, 16.0}, {3, 16.0}})
    EXPECT_NEAR(length[static_cast<std::size_t>(side)], expected, 1e-9);
}

TEST(Outline, CutsAreFollowedInsideIt) {
  const SheetPlan plan = plan_of(Outline({{box(-8, 8, -5, 5), box(-2, 2, -2, 2)}}), 1);
  const OutlinedCells made = meshed(plan, {{{-20, 0.5}, {20, 0.5}}, {{-6, 4}, {-4, 4}}});
  ASSERT_TRUE(made.unfollowed.empty());
  expect_tiles(plan, made.cells);
  EXPECT_NEAR(made.cuts[0].length, 12, 1e-9);
  EXPECT_NEAR(made.cuts[0].followed, 12, 1e-9);
  EXPECT_NEAR(made.cuts[1].length, 2, 1e-9);
  for (const auto& [a, b] : made.cuts[0].pairs) {
    const double one = made.cells.generators[static_cast<std::size_t>(a)][1],
                 other = made.cells.generators[static_cast<std::size_t>(b)][1];
    EXPECT_NEAR(one + other, 1, 1e-9);
  }
}

TEST(Outline, AreaCentroidAndPlaceOfPoints) {
  const Outline ring({{box(100, 110, 200, 206), box(104, 106, 202, 204)}});
  EXPECT_NEAR(ring.area(), 56, 1e-10);
  EXPECT_NEAR(ring.centroid()[0], 105, 1e-10);
  EXPECT_NEAR(ring.centroid()[1], (60 * 203 - 4 * 203) / 56.0, 1e-10);
  EXPECT_TRUE(ring.contains({101, 201}));
  EXPECT_FALSE(ring.contains({105, 203}));
  EXPECT_NEAR(ring.distance({105, 203.5}), 0.5, 1e-12);
  EXPECT_NE(ring.identity(), Outline({{box(100, 110, 200, 206)}}).identity());
  Ring clockwise = box(100, 110, 200, 206);
  std::reverse(clockwise.begin(), clockwise.end());
  EXPECT_NEAR(Outline({{clockwise}}).area(), 60, 1e-10);
}

TEST(Outline, SimplificationKeepsWithinItsToleranceAndFillsSmallHoles) {
  Ring rough = box(0, 10, 0, 10);
  rough.insert(rough.begin() + 1, {{2, 0}, {3, 0.2}, {4, 0}});
  const Outline given({{rough, box(7, 7.5, 7, 7.5)}});
  const auto [changed, without] = simplified(given, 0.6, Areas::changed);
  EXPECT_EQ(changed.corners(), 4U);
  EXPECT_NEAR(changed.area(), 100, 1e-12);
  EXPECT_NEAR(without, 0.2 + 0.25, 1e-12);
  const auto [outline, moved] = simplified(given, 0.6);
  EXPECT_EQ(outline.corners(), 4U);
  EXPECT_NEAR(outline.area(), 100 - 0.2 - 0.25, 1e-12);
  EXPECT_GT(moved, 0.45);
  EXPECT_LT(moved, 0.9);
  const auto [same, none] = simplified(given, 0);
  EXPECT_EQ(same.identity(), given.identity());
  EXPECT_EQ(none, 0);
  EXPECT_EQ(simplified(given, 0.1).outline.corners(), 11U);
}

TEST(Outline, SimplificationKeepsTheAreaOfPolygonsWithHoles) {
  std::mt19937 chance(3);
  const auto rough = [&](double radius, int corners) {
    Ring ring = circle(radius, corners);
    for (Point2& p : ring) {
      const double r = 1 + 0.02 * (static_cast<double>(chance()) / 4294967296.0 - 0.5);
      p = {r * p[0], r * p[1]};
    }
    return ring;
  };
  const Outline given({{rough(12, 400), rough(6, 150)}});
  ASSERT_EQ(given.flaw(), "");
  const auto [outline, moved] = simplified(given, 0.5);
  EXPECT_LT(outline.corners(), 50U);
  EXPECT_EQ(outline.flaw(), "");
  const auto area = [](const Outline& o, std::size_t ring) {
    return Outline({{o.polygons().front()[ring]}}).area();
  };
  for (const std::size_t ring : {0U, 1U})
    EXPECT_NEAR(area(outline, ring) / area(given, ring), 1, 1e-12);
  for (const Ring& ring : given.polygons().front())
    for (const Point2& p : ring) EXPECT_LE(outline.distance(p), 0.5 * (1 + 1e-12));
}

TEST(Outline, SimplifiedTogetherPolygonsThatTouchStillDo) {
  // The border between them is a zigzag with a bulge.
  Ring border;
  for (int k = 0; k <= 40; ++k)
    border.push_back({0.25 * k, 0.2 * (k % 2) + 0.3 * std::sin(0.1 * k)});
  Ring below{{0, -5}, {10, -5}}, above{{10, 6}, {0, 6}};
  below.insert(below.end(), border.rbegin(), border.rend());
  above.insert(above.end(), border.begin(), border.end());
  const Outline given({{below}, {above}});
  ASSERT_EQ(given.flaw(), "");
  const auto [outline, moved] = simplified(given, 0.6);
  EXPECT_LT(outline.corners(), 16U);
  EXPECT_EQ(outline.flaw(), "");
  double both = 0;
  for (std::size_t k = 0; k < 2; ++k) {
    const double area = Outline({outline.polygons()[k]}).area();
    EXPECT_NEAR(area / Outline({given.polygons()[k]}).area(), 1, 1e-10);
    both += area;
  }
  // No gap has opened: every corner of the border that is left is one of both.
  const Ring &one = outline.polygons()[0].front(), &other = outline.polygons()[1].front();
  const auto shared = std::count_if(one.begin(), one.end(), [&](const Point2& p) {
    return std::find(other.begin(), other.end(), p) != other.end();
  });
  EXPECT_GE(shared, 2);
  EXPECT_EQ(static_cast<std::size_t>(shared) + 2, one.size());
}

TEST(Outline, SimplificationKeepsPolygonsApart) {
  // A tooth of one reaches into a notch of the other.
  const Ring below{{0, 0}, {10, 0}, {10, 3}, {5.5, 3}, {5, 3.8}, {4.5, 3}, {0, 3}};
  const Ring above{{0, 3.1}, {4.4, 3.1}, {5, 4}, {5.6, 3.1}, {10, 3.1}, {10, 6}, {0, 6}};
  const Outline given({{below}, {above}});
  ASSERT_EQ(given.flaw(), "");
  for (const double tolerance : {0.5, 0.85, 2.0})
    EXPECT_EQ(simplified(given, tolerance).outline.flaw(), "") << tolerance;
}

TEST(Outline, Flaws) {
  const auto flaw = [](std::vector<RingedPolygon> polygons) { return Outline(polygons).flaw(); };
  const Ring whole = box(0, 10, 0, 10);
  EXPECT_EQ(flaw({{whole}}), "");
  EXPECT_EQ(flaw({{whole, box(1, 2, 1, 2), box(3, 4, 3, 4)}}), "");
  EXPECT_EQ(flaw({{whole}, {box(10, 12, 0, 10)}}), "");                // they touch
  EXPECT_EQ(flaw({{whole, box(2, 8, 2, 8)}, {box(3, 4, 3, 4)}}), "");  // in the lake of another
  EXPECT_NE(flaw({{{{0, 0}, {1, 0}}}}).find("has 2 different corners"), std::string::npos);
  EXPECT_NE(flaw({{{{0, 0}, {4, 4}, {4, 0}, {0, 4}}}}).find("crosses itself near (2, 2)"),
            std::string::npos);
  EXPECT_NE(flaw({{{{0, 0}, {4, 0}, {2, 0}, {2, 3}}}}).find("touches itself"), std::string::npos);
  EXPECT_NE(flaw({{whole, box(9, 11, 1, 2)}}).find("hole 1: crosses the outer ring"),
            std::string::npos);
  EXPECT_NE(flaw({{whole, box(20, 21, 1, 2)}}).find("hole 1: lies outside"), std::string::npos);
  EXPECT_NE(flaw({{whole, box(1, 4, 1, 4), box(2, 3, 2, 3)}}).find("hole 2: overlaps hole 1"),
            std::string::npos);
  EXPECT_NE(flaw({{whole}, {box(9, 12, 0, 10)}}), "");  // of one height: no edges cross
  EXPECT_NE(flaw({{whole}, {{{5, 0}, {10, 5}, {5, 10}, {0, 5}}}}), "");  // inscribed
  EXPECT_NE(flaw({{whole}, {whole}}), "");
  EXPECT_EQ(flaw({{whole, box(2, 8, 2, 8)}, {box(2, 8, 2, 8)}}), "");  // it fills the hole
  EXPECT_EQ(flaw({{whole}, {{{10, 5}, {14, 3}, {14, 7}}}}), "");       // a corner on an edge
  EXPECT_NE(flaw({{whole}, {box(5, 15, 5, 15)}}).find("polygon 1 and polygon 2: overlap"),
            std::string::npos);
  EXPECT_NE(flaw({{whole}, {box(2, 3, 2, 3)}}).find("overlap"), std::string::npos);
  EXPECT_NE(flaw({{whole}, {whole}}).find("overlap"), std::string::npos);
}

TEST(Outline, Files) {
  const std::string square = "[[0,0],[4,0],[4,4],[0,4],[0,0]]", hole = "[[1,1],[2,1],[2,2],[1,2]]";
  const std::string polygon = R"({"type":"Polygon","coordinates":[)" + square + "," + hole + "]}";
  const auto corners = [](const std::string& text, const std::string& name = "f") {
    std::vector<std::size_t> counts;
    for (const auto& feature : parse_outline(text, name))
      counts.push_back(Outline(feature.polygons).corners());
    return counts;
  };
  using Counts = std::vector<std::size_t>;
  EXPECT_EQ(corners(polygon), Counts{8});
  EXPECT_EQ(corners(R"({"type":"Feature","geometry":)" + polygon + "}"), Counts{8});
  EXPECT_EQ(corners(R"({"type":"MultiPolygon","coordinates":[[)" + square + "],[" + hole + "]]}"),
            Counts{8});
  EXPECT_EQ(corners(R"({"type":"FeatureCollection","features":[{"geometry":null},{"geometry":)" +
                    polygon + "}]}"),
            (Counts{0, 8}));
  EXPECT_EQ(corners(R"({"type":"GeometryCollection","geometries":[)" + polygon + "]}"), Counts{8});
  const auto thickness = [&](const std::string& properties) {
    return parse_outline(R"({"type":"Feature","properties":)" + properties + R"(,"geometry":)" +
                             polygon + "}",
                         "f")
        .front()
        .thickness;
  };
  EXPECT_EQ(thickness(R"({"id":3,"thickness":0.5})"), 0.5);
  for (const auto* none : {"null", "{}", R"({"thickness":null})", R"({"thickness":"0.5"})"})
    EXPECT_FALSE(thickness(none).has_value()) << none;
  // Tables: rings by empty lines or by the third column, holes by their place.
  EXPECT_EQ(corners("x,y\n0,0\n4,0\n4,4\n0,4\n0,0\n\n1,1\n2,1\n2,2\n"), Counts{7});
  EXPECT_EQ(corners("0;0;a\n4;0;a\n4;4;a\n9;9;b\n12;9;b # comment\n12;12;b\n"), (Counts{3, 3}));
  EXPECT_EQ(corners("# only\n0 0\n4\t0\r\n4 +4e0\n"), Counts{3});
  const auto refusal = [](const std::string& text, const std::string& name) {
    try {
      (void)parse_outline(text, name);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("taken");
  };
  EXPECT_EQ(refusal("{", "f.csv"), "sheet: outline: 'f.csv': is not JSON (at byte 2)");
  EXPECT_EQ(refusal("1,2\n", "f.geojson"), "sheet: outline: 'f.geojson': is not JSON (at byte 2)");
  EXPECT_EQ(refusal("", "f.csv"), "sheet: outline: 'f.csv': has no polygon");
  EXPECT_EQ(refusal("0,0\n1,a\n", "f"), "sheet: outline: 'f': line 2: is not x, y");
  EXPECT_EQ(refusal("0,0\n1,nan\n", "f"), "sheet: outline: 'f': line 2: is not x, y");
  EXPECT_EQ(refusal(R"({"type":"Point","coordinates":[1,2]})", "f"),
            "sheet: outline: 'f': the file is a Point; outlines are Polygon or MultiPolygon");
  EXPECT_EQ(refusal(R"({"type":"Polygon"})", "f"),
            "sheet: outline: 'f': the file has no \"coordinates\"");
  EXPECT_EQ(refusal(R"({"type":"Polygon","coordinates":[[[1,"a"]]]})", "f"),
            "sheet: outline: 'f': the file: position 1 is not [x, y]");
}

}  // namespace
}  // namespace floe
