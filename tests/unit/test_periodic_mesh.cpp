// Meshes of sheets that repeat themselves in y: against the cells among many images, whatever the
// place of the seam, and with beams to images.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>
#include <set>

#include "floe/base/item.h"
#include "floe/base/petsc.h"
#include "floe/geometry/polyhedron.h"
#include "floe/lattice/lattice.h"
#include "floe/mesh/strips.h"
#include "floe/mesh/tessellation.h"

namespace floe {
namespace {

SheetPlan plan_of(double length, double width, double l, int iterations = 40) {
  SheetPlan plan;
  plan.length = length, plan.width = width, plan.element_size = l, plan.iterations = iterations;
  plan.periodic = true;
  return plan;
}

std::vector<Point2> random_points(std::size_t n, const SheetPlan& plan) {
  std::mt19937_64 engine(5);
  std::uniform_real_distribution<double> part(-0.5, 0.5);
  std::vector<Point2> points(n);
  for (auto& [x, y] : points) x = plan.length * part(engine), y = plan.width * part(engine);
  return points;
}

/// Facets by cells; each with its width and its shift.
using Facets = std::map<std::array<std::int32_t, 2>, std::array<double, 2>>;
Facets facets_of(const Tessellation& cells) {
  Facets all;
  for (const Facet& f : cells.facets) all[f.cells] = {f.width, f.shift};
  return all;
}

/// Expects the facets and areas of a periodic tessellation to be those of the middle one of seven
/// copies of the plan on top of one another.
void expect_same_as_among_copies(const SheetPlan& plan, const std::vector<Point2>& points) {
  const Tessellation own = tessellate(plan, points);
  SheetPlan tall = plan;
  tall.periodic = false, tall.width = 7 * plan.width;
  std::vector<Point2> copies;
  for (const int k : {0, -3, -2, -1, 1, 2, 3})
    for (const auto& [x, y] : points) copies.push_back({x, y + k * plan.width});
  const Tessellation many = tessellate(tall, copies);
  const auto n = static_cast<std::int32_t>(points.size());
  Facets expected;
  for (const Facet& f : many.facets) {
    const auto [i, j] = f.cells;
    if (i >= n) continue;
    const double shift = item(copies, j)[1] - item(points, j % n)[1];
    if (j % n > i) expected[{i, j % n}] = {f.width, shift};
  }
  const Facets found = facets_of(own);
  ASSERT_EQ(found.size(), own.facets.size()) << "two facets of the same cells";
  ASSERT_EQ(found.size(), expected.size());
  for (const auto& [pair, facet] : found) {
    ASSERT_TRUE(expected.contains(pair)) << pair[0] << " " << pair[1];
    EXPECT_NEAR(facet[0], expected[pair][0], 1e-9);
    EXPECT_NEAR(facet[1], expected[pair][1], 1e-9);
  }
  double area = 0;
  for (std::int32_t k = 0; k < n; ++k)
    area +=
        plan_properties(std::span(own.vertices)
                            .subspan(static_cast<std::size_t>(own.offset[k]),
                                     static_cast<std::size_t>(own.offset[k + 1] - own.offset[k])))
            .area;
  EXPECT_NEAR(area, plan.length * plan.width, 1e-9 * area);
}

TEST(PeriodicMesh, IsThatAmongManyImages) {
  const SheetPlan plan = plan_of(30, 12, 1);
  expect_same_as_among_copies(plan, random_points(number_of_cells(plan), plan));
  // So few generators that images of all are needed.
  const SheetPlan few = plan_of(30, 12, 4);
  expect_same_as_among_copies(few, tessellate(few, PETSC_COMM_SELF).generators);
}

TEST(PeriodicMesh, DoesNotSeeItsSeam) {
  const SheetPlan plan = plan_of(20, 12, 1.5);
  const std::vector<Point2> points = tessellate(plan, PETSC_COMM_SELF).generators;
  std::vector<Point2> moved = points;
  for (auto& [x, y] : moved) y += y > 2 ? -8 : 4;  // by a third of the period
  const Tessellation a = tessellate(plan, points), b = tessellate(plan, moved);
  const Facets one = facets_of(a), other = facets_of(b);
  ASSERT_EQ(one.size(), other.size());
  for (const auto& [pair, facet] : one) EXPECT_NEAR(facet[0], other.at(pair)[0], 1e-9);
  EXPECT_NEAR(a.energy_ratio, b.energy_ratio, 1e-9);
  // A relaxed one is as regular across the seam as elsewhere: no line of facets, little energy.
  SheetPlan whole = plan;
  whole.periodic = false;
  EXPECT_LT(a.energy_ratio, tessellate(whole, PETSC_COMM_SELF).energy_ratio);
  double across = 0, farthest = 0;
  for (const Facet& f : a.facets) across += f.shift != 0 ? f.width : 0;
  for (std::size_t k = 0; k < a.generators.size(); ++k)
    for (std::int32_t v = a.offset[k]; v < a.offset[k + 1]; ++v)
      farthest = std::max(farthest, std::abs(a.vertices[static_cast<std::size_t>(v)][1]));
  EXPECT_GT(across, 1.05 * plan.length);
  EXPECT_LT(across, 1.6 * plan.length);
  EXPECT_GT(farthest, plan.width / 2 + 0.2 * plan.element_size);
  for (const std::uint8_t side : a.sides) EXPECT_EQ(side & (side_bottom | side_top), 0);
}

TEST(PeriodicMesh, HasBeamsToImages) {
  const SheetPlan plan = plan_of(20, 12, 1.5);
  Lattice lattice = make_sheet(tessellate(plan, PETSC_COMM_SELF), {});
  (void)reorder(lattice);
  ASSERT_EQ(lattice.beams.image.size(), lattice.beams.bodies.size());
  int images = 0;
  for (std::int32_t m = 0; m < lattice.beams.size(); ++m) {
    const Point3 way = chord(lattice.bodies, lattice.beams, m);
    EXPECT_NEAR(length(way), item(lattice.beams.length, m), 1e-12);
    EXPECT_LT(length(way), 3 * plan.element_size);
    EXPECT_NEAR(dot(way, item(lattice.beams.axis_y, m)), 0, 1e-12);
    images += item(lattice.beams.image, m).y != 0;
  }
  EXPECT_GT(images, 20);
  EXPECT_TRUE(lattice.sets.at("bottom").empty());
  EXPECT_FALSE(lattice.sets.at("left").empty());
}

TEST(PeriodicMesh, TooNarrowOnesAreRefused) {
  const SheetPlan plan = plan_of(20, 2, 1.5);
  EXPECT_THROW((void)tessellate(plan, PETSC_COMM_SELF), InputError);
}

/// Strips of a periodic sheet: the whole length of all polygons' edges is that of the facets.
TEST(PeriodicMesh, OfStrips) {
  SheetPlan plan = plan_of(16, 12, 1.5);
  Strips strips(plan, PETSC_COMM_SELF);
  const auto width = [](const std::vector<Facet>& facets) {
    double sum = 0;
    for (const Facet& facet : facets) sum += facet.width;
    return sum;
  };
  for (std::int32_t k = 1; k < 4; ++k) {
    const StripCells strip = strips.strip(k), before = strips.strip(k - 1);
    double edges = 0;
    for (std::size_t c = 0; c + 1 < strip.offset.size(); ++c) {
      const auto first = static_cast<std::size_t>(strip.offset[c]),
                 end = static_cast<std::size_t>(strip.offset[c + 1]);
      for (std::size_t v = first; v < end; ++v) {
        const auto &p = strip.vertices[v], &q = strip.vertices[v + 1 < end ? v + 1 : first];
        edges += std::hypot(q[0] - p[0], q[1] - p[1]);
      }
    }
    EXPECT_NEAR(edges, 2 * width(strip.inside) + width(strip.to_next) + width(before.to_next),
                1e-9 * edges);
    int shifted = 0;
    for (const Facet& f : strip.to_next) shifted += f.shift != 0;
    for (const Facet& f : strip.inside) shifted += f.shift != 0;
    EXPECT_GT(shifted, 8);
  }
}

}  // namespace
}  // namespace floe
