// Cells that end on the lines of cuts: facets from end to end of each line, no cell across it, and
// cells as good as elsewhere.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "floe/base/petsc.h"
#include "floe/geometry/polyhedron.h"
#include "floe/mesh/cuts.h"
#include "support/static_solution.h"

namespace floe {
namespace {

SheetPlan plan_of(double length, double width, double l, std::uint64_t seed = 1) {
  SheetPlan plan;
  plan.length = length, plan.width = width, plan.element_size = l, plan.seed = seed;
  return plan;
}

std::span<const Point2> polygon(const Tessellation& t, std::size_t k) {
  return std::span(t.vertices).subspan(t.offset[k], t.offset[k + 1] - t.offset[k]);
}

/// Place along a line and offset to its left [m].
Point2 local(const CutLine& line, const Point2& p) {
  const double dx = line.to[0] - line.from[0], dy = line.to[1] - line.from[1];
  const double length = std::hypot(dx, dy), x = p[0] - line.from[0], y = p[1] - line.from[1];
  return {(dx * x + dy * y) / length, (dx * y - dy * x) / length};
}

struct Part {
  double begin = 0, end = 0;
};

/// The part of a line inside the plan.
Part inside(const SheetPlan& plan, const CutLine& line) {
  Part part{0, std::hypot(line.to[0] - line.from[0], line.to[1] - line.from[1])};
  const double length = part.end;
  for (int axis = 0; axis < 2; ++axis) {
    const double half = (axis == 0 ? plan.length : plan.width) / 2;
    const double rate = (line.to[axis] - line.from[axis]) / length;
    if (rate == 0) continue;
    const double a = (-half - line.from[axis]) / rate, b = (half - line.from[axis]) / rate;
    part.begin = std::max(part.begin, std::min(a, b));
    part.end = std::min(part.end, std::max(a, b));
  }
  return part;
}

/// Length of the edges on a line of the cells to its left (side 1) or right (-1) [m].
double edges_on(const Tessellation& t, const CutLine& line, const Part& part, int side) {
  double sum = 0;
  for (std::size_t k = 0; k + 1 < t.offset.size(); ++k) {
    const auto cell = polygon(t, k);
    const PlanProperties properties = plan_properties(cell);
    if (side * local(line, properties.centroid)[1] < 0) continue;
    for (std::size_t i = 0; i < cell.size(); ++i) {
      const auto [s0, d0] = local(line, cell[i]);
      const auto [s1, d1] = local(line, cell[(i + 1) % cell.size()]);
      if (std::abs(d0) > 1e-9 || std::abs(d1) > 1e-9) continue;
      sum += std::max(
          0.0, std::min(std::max(s0, s1), part.end) - std::max(std::min(s0, s1), part.begin));
    }
  }
  return sum;
}

/// Length of a line that lies inside cells [m].
double length_in_cells(const Tessellation& t, const CutLine& line, const Part& part) {
  double sum = 0;
  for (std::size_t k = 0; k + 1 < t.offset.size(); ++k) {
    const auto cell = polygon(t, k);
    double low = 0, high = 0, from = 1e300, to = -1e300;
    for (std::size_t i = 0; i < cell.size(); ++i) {
      const auto [s0, d0] = local(line, cell[i]);
      const auto [s1, d1] = local(line, cell[(i + 1) % cell.size()]);
      low = std::min(low, d0), high = std::max(high, d0);
      if ((d0 > 0) == (d1 > 0)) continue;
      const double s = s0 + (s1 - s0) * d0 / (d0 - d1);
      from = std::min(from, s), to = std::max(to, s);
    }
    if (low > -1e-9 || high < 1e-9) continue;
    sum += std::max(0.0, std::min(to, part.end) - std::max(from, part.begin));
  }
  return sum;
}

/// \param smallest  lower bound of the areas of cells, over their mean
/// \param more  largest change of the number of cells, over their number
void expect_good_cells(const SheetPlan& plan, const Tessellation& t, double smallest,
                       double more = 0.06) {
  const double area = plan.length * plan.width;
  const auto n = static_cast<double>(t.generators.size());
  double sum = 0;
  for (std::size_t k = 0; k + 1 < t.offset.size(); ++k) {
    const auto cell = polygon(t, k);
    ASSERT_GE(cell.size(), 3U);
    for (std::size_t i = 0; i < cell.size(); ++i) {
      const Point2 &a = cell[i], &b = cell[(i + 1) % cell.size()], &c = cell[(i + 2) % cell.size()];
      EXPECT_GE((b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0]), -1e-9);
    }
    const double own = plan_properties(cell).area;
    EXPECT_GT(own, smallest * area / n) << t.generators[k][0] << " " << t.generators[k][1];
    EXPECT_LT(own, 1.8 * area / n) << t.generators[k][0] << " " << t.generators[k][1];
    sum += own;
  }
  EXPECT_NEAR(sum / area, 1, 1e-12);
  EXPECT_NEAR(n / static_cast<double>(number_of_cells(plan)), 1, more);
}

FittedCells fitted(const SheetPlan& plan, const std::vector<CutLine>& lines) {
  return fit_to_cuts(plan, tessellate(plan, MPI_COMM_SELF), lines, MPI_COMM_SELF);
}

void expect_followed(const SheetPlan& plan, const std::vector<CutLine>& lines,
                     double smallest = 0.4, double more = 0.06) {
  const FittedCells result = fitted(plan, lines);
  expect_good_cells(plan, result.cells, smallest, more);
  ASSERT_EQ(result.cuts.size(), lines.size());
  for (std::size_t k = 0; k < lines.size(); ++k) {
    SCOPED_TRACE(k);
    const Part part = inside(plan, lines[k]);
    const double length = part.end - part.begin;
    EXPECT_NEAR(result.cuts[k].length, length, 1e-12 * plan.length);
    EXPECT_NEAR(result.cuts[k].followed, length, 1e-9);
    for (const int side : {1, -1})
      EXPECT_NEAR(edges_on(result.cells, lines[k], part, side), length, 1e-9);
    EXPECT_LT(length_in_cells(result.cells, lines[k], part), 1e-9);
    for (const auto& [i, j] : result.cuts[k].pairs) {  // images of each other in the line
      const Point2 a = local(lines[k], result.cells.generators[static_cast<std::size_t>(i)]);
      const Point2 b = local(lines[k], result.cells.generators[static_cast<std::size_t>(j)]);
      EXPECT_NEAR(a[0], b[0], 1e-12 * plan.length);
      EXPECT_NEAR(a[1], -b[1], 1e-12 * plan.length);
    }
  }
}

CutLine turned(double degrees, double length, const Point2& middle = {0, 0}) {
  const double a = degrees * std::numbers::pi / 180;
  const double x = 0.5 * length * std::cos(a), y = 0.5 * length * std::sin(a);
  return {{middle[0] - x, middle[1] - y}, {middle[0] + x, middle[1] + y}};
}

TEST(FitToCuts, FacetsCoverALineInsideTheSheet) {
  for (const double degrees : {0, 30, 45, 73, 90, 135}) {
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      SCOPED_TRACE(std::to_string(degrees) + " " + std::to_string(seed));
      expect_followed(plan_of(20, 16, 1, seed), {turned(degrees, 7.3, {0.3, -0.2})});
    }
  }
}

TEST(FitToCuts, ShortAndLongLines) {
  for (const double length : {0.5, 0.8, 1.0, 1.7, 2.4, 3.1, 14.0}) {
    SCOPED_TRACE(length);
    expect_followed(plan_of(20, 16, 1), {turned(20, length)}, 0.1);
  }
}

TEST(FitToCuts, LinesMeetTheOutline) {
  for (const double degrees : {20, 30, 45, 60, 90, 110, 150}) {
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      SCOPED_TRACE(std::to_string(degrees) + " " + std::to_string(seed));
      const SheetPlan plan = plan_of(20, 16, 1, seed);
      expect_followed(plan, {turned(degrees, 11, {0.4, -8})}, 0.1);    // one end beyond
      expect_followed(plan, {turned(degrees, 100, {0.1, 0.3})}, 0.1);  // from side to side
    }
  }
}

TEST(FitToCuts, FromCornerToCorner) {
  expect_followed(plan_of(20, 16, 1), {{{-10, -8}, {10, 8}}}, 0.25);
}

TEST(FitToCuts, NarrowStrips) {
  for (const double width : {0.6, 1.0, 1.5, 2.0, 2.3, 2.9, 3.7}) {
    SCOPED_TRACE(width);
    expect_followed(plan_of(20, 16, 1),
                    {{{-4, width / 2}, {4, width / 2}}, {{-4.3, -width / 2}, {4.2, -width / 2}}},
                    width < 1 ? 0.1 : 0.2, width < 1 ? 0.15 : 0.06);
  }
}

TEST(FitToCuts, CrossingLines) {
  for (const double degrees : {30, 45, 60, 90, 120}) {
    SCOPED_TRACE(degrees);
    expect_followed(plan_of(20, 16, 1), {turned(10, 9), turned(10 + degrees, 8, {0.5, 0.4})}, 0.15);
  }
  expect_followed(plan_of(20, 16, 1), {turned(0, 9), turned(60, 9), turned(120, 9)}, 0.15);
}

TEST(FitToCuts, LinesThatMeetAtTheirEnds) {
  for (const double degrees : {30, 45, 60, 90, 110, 135, 160, 180}) {
    SCOPED_TRACE(degrees);
    const double a = degrees * std::numbers::pi / 180;
    const Point2 corner{0.2, -0.1};
    expect_followed(plan_of(20, 16, 1),
                    {{{corner[0] + 5, corner[1]}, corner},
                     {corner, {corner[0] + 6 * std::cos(a), corner[1] + 6 * std::sin(a)}}},
                    0.15);
    expect_followed(
        plan_of(20, 16, 1),  // one ends on the other
        {{{-6, corner[1]}, {5, corner[1]}},
         {corner, {corner[0] + 5 * std::cos(a / 2 + 0.3), corner[1] + 5 * std::sin(a / 2 + 0.3)}}},
        0.15);
  }
}

/// Many lines at random places: what is followed is followed to rounding, and the cells tile the
/// plan whatever else.
TEST(FitToCuts, AnyLines) {
  std::uint64_t state = 12345;
  const auto random = [&state](double low, double high) {
    state = state * 6364136223846793005ULL + 1442695040888963407ULL;
    return low + (high - low) * static_cast<double>(state >> 11U) * 0x1p-53;
  };
  double length = 0, followed = 0;
  for (int trial = 0; trial < 40; ++trial) {
    SCOPED_TRACE(trial);
    const SheetPlan plan = plan_of(20, 16, 1, static_cast<std::uint64_t>(trial));
    std::vector<CutLine> lines(static_cast<std::size_t>(random(1, 7)));
    for (CutLine& line : lines)
      line = {{random(-11, 11), random(-9, 9)}, {random(-11, 11), random(-9, 9)}};
    const FittedCells result = fitted(plan, lines);
    double area = 0;
    for (std::size_t k = 0; k + 1 < result.cells.offset.size(); ++k)
      area += plan_properties(polygon(result.cells, k)).area;
    EXPECT_NEAR(area / 320, 1, 1e-12);
    for (std::size_t k = 0; k < lines.size(); ++k) {
      const Part part = inside(plan, lines[k]);
      EXPECT_NEAR(result.cuts[k].length, std::max(0.0, part.end - part.begin), 1e-9);
      EXPECT_LT(result.cuts[k].followed, result.cuts[k].length + 1e-9);
      EXPECT_LT(length_in_cells(result.cells, lines[k], part),
                result.cuts[k].length - result.cuts[k].followed + 1e-9);
      length += result.cuts[k].length, followed += result.cuts[k].followed;
    }
  }
  EXPECT_GT(followed / length, 0.75);
}

TEST(FitToCuts, AnyLinesInAnySheet) {
  std::uint64_t state = 54321;
  const auto random = [&state](double low, double high) {
    state = state * 6364136223846793005ULL + 1442695040888963407ULL;
    return low + (high - low) * static_cast<double>(state >> 11U) * 0x1p-53;
  };
  for (int trial = 0; trial < 200; ++trial) {
    SCOPED_TRACE(trial);
    const double x = random(1, 12), y = random(1, 12);
    SheetPlan plan = plan_of(x, y, random(0.1, 1) * std::min(x, y));
    plan.iterations = 20;
    std::vector<CutLine> lines(static_cast<std::size_t>(random(1, 5)));
    for (CutLine& line : lines) {
      for (Point2* end : {&line.from, &line.to}) {
        *end = {random(-0.6, 0.6) * x, random(-0.6, 0.6) * y};
        if (random(0, 1) < 0.3) (*end)[0] = std::round((*end)[0]);
        if (random(0, 1) < 0.3) (*end)[1] = std::round((*end)[1]);
      }
      if (line.from == line.to) line.to[0] += 0.1 * x;
    }
    const FittedCells result = fitted(plan, lines);
    double area = 0;
    for (std::size_t k = 0; k + 1 < result.cells.offset.size(); ++k)
      area += plan_properties(polygon(result.cells, k)).area;
    EXPECT_NEAR(area / (x * y), 1, 1e-12);
    for (std::size_t k = 0; k < lines.size(); ++k)
      EXPECT_LT(length_in_cells(result.cells, lines[k], inside(plan, lines[k])),
                result.cuts[k].length - result.cuts[k].followed + 1e-9);
  }
}

TEST(FitToCuts, LinesThatAreTooCloseAreLeft) {
  const SheetPlan plan = plan_of(20, 16, 1);
  const std::vector<CutLine> lines{{{-4, 0}, {4, 0}}, {{-4, 0.03}, {4, 0.03}}};
  const FittedCells result = fitted(plan, lines);
  expect_good_cells(plan, result.cells, 0.3);
  EXPECT_NEAR(result.cuts[0].followed, 8, 1e-9);
  EXPECT_EQ(result.cuts[1].followed, 0);
  EXPECT_TRUE(result.cuts[1].pairs.empty());
}

TEST(FitToCuts, LinesOutsideOrAlongTheOutlineChangeNothing) {
  const SheetPlan plan = plan_of(20, 16, 1);
  const Tessellation whole = tessellate(plan, MPI_COMM_SELF);
  const FittedCells result = fitted(plan, {{{-20, 9}, {20, 9}}, {{-10, -5}, {-10, 5}}});
  EXPECT_EQ(result.cells.generators, whole.generators);
  EXPECT_EQ(result.cells.vertices, whole.vertices);
  for (const FittedCut& cut : result.cuts) EXPECT_EQ(cut.followed, 0);
}

TEST(FitToCuts, CellsFarFromTheLinesStay) {
  const SheetPlan plan = plan_of(40, 16, 1);
  const Tessellation whole = tessellate(plan, MPI_COMM_SELF);
  const CutLine line{{-15, -3}, {-15, 3}};
  auto before = whole.generators, after = fitted(plan, {line}).cells.generators;
  const auto near_line = [&](const Point2& p) { return p[0] < -15 + 4.6; };
  std::erase_if(before, near_line);
  std::erase_if(after, near_line);
  std::sort(before.begin(), before.end());
  std::sort(after.begin(), after.end());
  EXPECT_GT(before.size(), 400U);
  EXPECT_EQ(after, before);
}

Scene block_cut_out(bool fit) {
  Scene scene;
  scene.has_sheet = true;
  scene.sheet = plan_of(20, 16, 1, 3);
  scene.forces.beam = true;
  scene.fit_cuts = fit;
  const std::vector<Point2> corners{{1, -2}, {4.5, -2}, {4.5, 1.7}, {1, 1.7}};
  for (std::size_t k = 0; k < 4; ++k)
    scene.cuts.push_back(
        {.name = "c" + std::to_string(k), .from = corners[k], .to = corners[(k + 1) % 4]});
  return scene;
}

/// Masses of the pieces that beams join, the smallest first [kg].
std::vector<double> pieces(const Lattice& lattice) {
  std::vector<std::size_t> piece(lattice.bodies.mass.size());
  for (std::size_t b = 0; b < piece.size(); ++b) piece[b] = b;
  for (bool changed = true; changed;) {
    changed = false;
    for (const auto& [i, j] : lattice.beams.bodies) {
      auto &a = piece[static_cast<std::size_t>(i)], &b = piece[static_cast<std::size_t>(j)];
      changed = changed || a != b;
      a = b = std::min(a, b);
    }
  }
  std::map<std::size_t, double> mass;
  for (std::size_t b = 0; b < piece.size(); ++b) mass[piece[b]] += lattice.bodies.mass[b];
  std::vector<double> all;
  for (const auto& [root, m] : mass) all.push_back(m);
  std::sort(all.begin(), all.end());
  return all;
}

TEST(FitToCuts, ABlockThatIsCutOutHasTheSizeOfItsCuts) {
  const Scene scene = block_cut_out(true);
  const std::vector<double> masses = pieces(test::mesh_of(scene));
  ASSERT_EQ(masses.size(), 2U);
  const double area = 3.5 * 3.7, layer = scene.ice.density * scene.thickness;
  EXPECT_NEAR(masses[0], area * layer, 1e-11 * masses[0]);
  EXPECT_NEAR(masses[1], (320 - area) * layer, 1e-11 * masses[1]);
}

TEST(FitToCuts, WithoutItCutsFollowTheCells) {
  const Scene scene = block_cut_out(false);
  Lattice expected = make_sheet(tessellate(scene.sheet, MPI_COMM_SELF),
                                {scene.thickness, 0, scene.ice, scene.shear_factor, scene.torsion});
  for (const Cut& c : scene.cuts) cut(expected, c.from, c.to);
  (void)reorder(expected);
  const Lattice lattice = test::mesh_of(scene);
  EXPECT_EQ(lattice.beams.bodies, expected.beams.bodies);
  EXPECT_EQ(lattice.bodies.mass, expected.bodies.mass);
  const std::vector<double> masses = pieces(lattice);
  ASSERT_EQ(masses.size(), 2U);
  EXPECT_GT(std::abs(masses[0] / (3.5 * 3.7 * scene.ice.density * scene.thickness) - 1), 1e-3);
}

TEST(FitToCuts, ARemarkNamesTheCutThatIsNotFollowed) {
  Scene scene = block_cut_out(true);
  MeshReport report;
  (void)make_lattice(scene, PETSC_COMM_SELF, report);
  EXPECT_EQ(report.cuts, "");
  scene.cuts.push_back({.name = "hair", .from = {1, 1.73}, .to = {4.5, 1.73}});
  scene.cuts.back().may_miss = true;
  (void)make_lattice(scene, PETSC_COMM_SELF, report);
  EXPECT_EQ(report.cuts.find("cut: hair: the cells do not end on it everywhere (14.4 of 17.9 m"),
            0U)
      << report.cuts;
}

}  // namespace
}  // namespace floe
