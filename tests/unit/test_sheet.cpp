// From cells to bodies and beams; torsion constants; cuts and regions.
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "floe/base/petsc.h"
#include "floe/lattice/lattice.h"

namespace floe {
namespace {

Tessellation cells(double length, double width, double l, int iterations = 20) {
  SheetPlan plan;
  plan.length = length, plan.width = width, plan.element_size = l, plan.iterations = iterations;
  return tessellate(plan, MPI_COMM_SELF);
}

std::span<const Point2> polygon(const Tessellation& cells, std::int32_t k) {
  return {cells.vertices.data() + cells.offset[static_cast<std::size_t>(k)],
          cells.vertices.data() + cells.offset[static_cast<std::size_t>(k) + 1]};
}

TEST(Torsion, PublishedValues) {
  // Timoshenko & Goodier, Theory of Elasticity, art. 109, table; more digits: the series summed.
  EXPECT_NEAR(saint_venant_torsion(1, 1), 0.140577, 5e-7);
  EXPECT_NEAR(saint_venant_torsion(2, 1), 2 * 0.228682, 1e-6);
  EXPECT_NEAR(saint_venant_torsion(3, 1), 3 * 0.263317, 2e-6);
  EXPECT_NEAR(saint_venant_torsion(10, 1), 10 * 0.312, 5e-3);
  EXPECT_NEAR(saint_venant_torsion(1e9, 1) / 1e9, 1.0 / 3, 1e-9);
}

TEST(Torsion, EqualsThePlainSeries) {
  for (const double ratio : {1.0, 1.03, 1.7, 4.0, 50.0}) {
    double sum = 0;
    const double pi = std::acos(-1.0);
    for (int n = 20001; n > 0; n -= 2) sum += std::tanh(n * pi * ratio / 2) / std::pow(n, 5);
    const double j = ratio * (1.0 / 3 - 64 / (std::pow(pi, 5) * ratio) * sum);
    EXPECT_NEAR(saint_venant_torsion(ratio, 1) / j, 1, 4e-15) << ratio;
  }
}

TEST(Torsion, OrderScaleAndExtremes) {
  EXPECT_EQ(saint_venant_torsion(0.3, 1.7), saint_venant_torsion(1.7, 0.3));
  EXPECT_NEAR(saint_venant_torsion(3e-4, 2e-4) / saint_venant_torsion(3, 2) * 1e16, 1, 1e-14);
  EXPECT_TRUE(std::isfinite(saint_venant_torsion(1e-9, 1)));
  EXPECT_GT(saint_venant_torsion(1e-9, 1), 0);
  EXPECT_EQ(saint_venant_torsion(0, 1), 0);
}

TEST(Sheet, MassAndInertiaOfTheWholePlan) {
  const double lx = 30, ly = 17;
  SheetSection section;
  section.thickness = 1.3, section.mid_plane = -0.1, section.ice.density = 900;
  const Lattice s = make_sheet(cells(lx, ly, 2), section);
  const double mass = 900 * lx * ly * 1.3;
  EXPECT_NEAR(std::accumulate(s.bodies.mass.begin(), s.bodies.mass.end(), 0.0) / mass, 1, 1e-12);
  // Steiner: the bodies' own inertia and their places make up that of the whole sheet.
  double about_z = 0, about_x = 0;
  for (std::int32_t k = 0; k < s.bodies.size(); ++k) {
    const Point3 &x = s.bodies.position[k], &j = s.bodies.inertia[k];
    const auto& q = s.bodies.orientation[k];
    const double c = q[0] * q[0] - q[3] * q[3], n = 2 * q[0] * q[3];
    EXPECT_NEAR(q[0] * q[0] + q[3] * q[3], 1, 1e-15);
    EXPECT_EQ(q[1], 0);
    EXPECT_EQ(q[2], 0);
    EXPECT_EQ(x[2], -0.1);
    EXPECT_LE(j[0], j[1] * (1 + 1e-12));
    about_z += j[2] + s.bodies.mass[k] * (x[0] * x[0] + x[1] * x[1]);
    about_x += c * c * j[0] + n * n * j[1] + s.bodies.mass[k] * x[1] * x[1];
  }
  EXPECT_NEAR(about_z / (mass * (lx * lx + ly * ly) / 12), 1, 1e-12);
  EXPECT_NEAR(about_x / (mass * (ly * ly + 1.3 * 1.3) / 12), 1, 1e-12);
}

TEST(Sheet, ShapesArePrismsOnPrincipalAxes) {
  SheetSection section;
  section.thickness = 0.7;
  const Tessellation mesh = cells(12, 9, 1.5, 3);
  const Lattice s = make_sheet(mesh, section);
  ASSERT_EQ(s.shapes.bodies(), s.bodies.size());
  for (std::int32_t k = 0; k < s.bodies.size(); ++k) {
    const VolumeProperties v = volume_properties(s.shapes, k);
    const double rho = section.ice.density;
    EXPECT_NEAR(v.volume * rho / s.bodies.mass[k], 1, 1e-12);
    for (int i = 0; i < 9; ++i) {
      const double expected = i % 4 == 0 ? s.bodies.inertia[k][i / 4] : 0;
      EXPECT_NEAR(v.inertia[i] * rho / s.bodies.inertia[k][2], expected / s.bodies.inertia[k][2],
                  1e-12);
    }
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(v.centroid[i], 0, 1e-12);
    // Placed in the world, the prism stands over its cell.
    const auto& q = s.bodies.orientation[k];
    const double c = q[0] * q[0] - q[3] * q[3], n = 2 * q[0] * q[3];
    const auto corners = mesh.offset[k + 1] - mesh.offset[k];
    ASSERT_EQ(s.shapes.vertex_of[k + 1] - s.shapes.vertex_of[k], 2 * corners);
    for (std::int32_t i = 0; i < corners; ++i) {
      const Point3& p = s.shapes.vertices[s.shapes.vertex_of[k] + i];
      const Point2& world = mesh.vertices[mesh.offset[k] + i];
      EXPECT_NEAR(s.bodies.position[k][0] + c * p[0] - n * p[1], world[0], 1e-12);
      EXPECT_NEAR(s.bodies.position[k][1] + n * p[0] + c * p[1], world[1], 1e-12);
      EXPECT_EQ(p[2], -0.35);
    }
    EXPECT_EQ(s.shapes.face_of[k + 1] - s.shapes.face_of[k], corners + 2);
  }
}

TEST(Sheet, SymmetricCellKeepsTheWorldAxes) {
  SheetPlan plan;
  plan.length = plan.width = 3, plan.element_size = 3;
  const Lattice s = make_sheet(tessellate(plan, {{0, 0}}), {});
  ASSERT_EQ(s.bodies.size(), 1);
  EXPECT_EQ(s.bodies.orientation[0], (std::array<double, 4>{1, 0, 0, 0}));
  EXPECT_EQ(s.beams.size(), 0);
  for (const char* side : {"left", "right", "bottom", "top"})
    EXPECT_EQ(s.sets.at(side), std::vector<std::int32_t>{0}) << side;
}

TEST(Sheet, LongAxisComesFirstWhateverItsDirection) {
  // Rectangles turned in plan: axis 1 must be the long one (least moment of inertia), right-handed
  // with +z.
  for (int step = 0; step < 16; ++step) {
    const double angle = 0.01 + step * std::acos(-1.0) / 8, c = std::cos(angle),
                 n = std::sin(angle);
    Tessellation one;
    one.generators = {{0, 0}};
    for (const auto& [x, y] : {Point2{-2, -1}, Point2{2, -1}, Point2{2, 1}, Point2{-2, 1}})
      one.vertices.push_back({c * x - n * y, n * x + c * y});
    one.offset = {0, 4};
    one.sides = {0};
    const Lattice s = make_sheet(one, {});
    const auto& q = s.bodies.orientation[0];
    const double ax = q[0] * q[0] - q[3] * q[3], ay = 2 * q[0] * q[3];
    EXPECT_NEAR(std::abs(ax * c + ay * n), 1, 1e-12) << step;
    EXPECT_NEAR(s.bodies.inertia[0][0], 920 * 8 * (4.0 + 1) / 12, 1e-9);
    EXPECT_NEAR(s.bodies.inertia[0][1], 920 * 8 * (16.0 + 1) / 12, 1e-9);
    EXPECT_NEAR(std::abs(s.shapes.vertices[0][0]), 2, 1e-12);
  }
}

TEST(Sheet, BeamsFollowTheFacets) {
  const Tessellation mesh = cells(15, 15, 2);
  SheetSection section;
  section.thickness = 0.8;
  section.ice.young = 5e9, section.ice.poisson = 0.25;
  const Lattice s = make_sheet(mesh, section);
  ASSERT_EQ(s.beams.size(), static_cast<std::int32_t>(mesh.facets.size()));
  for (std::int32_t m = 0; m < s.beams.size(); ++m) {
    const auto [i, j] = s.beams.bodies[m];
    EXPECT_LT(i, j);
    const double w = mesh.facets[m].width, h = 0.8;
    const Point3 &a = s.bodies.position[i], &b = s.bodies.position[j];
    EXPECT_DOUBLE_EQ(s.beams.area[m], w * h);
    EXPECT_DOUBLE_EQ(s.beams.inertia_y[m], w * h * h * h / 12);
    EXPECT_DOUBLE_EQ(s.beams.inertia_z[m], h * w * w * w / 12);
    EXPECT_DOUBLE_EQ(s.beams.torsion[m], saint_venant_torsion(w, h));
    EXPECT_DOUBLE_EQ(s.beams.shear_modulus[m], 2e9);
    EXPECT_DOUBLE_EQ(s.beams.length[m], std::hypot(b[0] - a[0], b[1] - a[1]));
    const Point3& y = s.beams.axis_y[m];
    const double l = s.beams.length[m];
    EXPECT_NEAR(y[0] * (b[0] - a[0]) + y[1] * (b[1] - a[1]), 0, 1e-14 * l);
    EXPECT_NEAR(((b[0] - a[0]) * y[1] - (b[1] - a[1]) * y[0]) / l, 1, 1e-14);  // axis 3 is +z
  }
  section.torsion = Torsion::polar;
  const Lattice p = make_sheet(mesh, section);
  EXPECT_DOUBLE_EQ(p.beams.torsion[0], p.beams.inertia_y[0] + p.beams.inertia_z[0]);
}

TEST(Sheet, EdgeSetsLieOnTheirSides) {
  const Lattice s = make_sheet(cells(40, 40, 2, 60), {});
  double left = -100, top = -100;
  for (const auto k : s.sets.at("left")) left = std::max(left, s.bodies.position[k][0]);
  for (const auto k : s.sets.at("top")) top = std::max(top, -s.bodies.position[k][1]);
  EXPECT_LT(left, -17.5);
  EXPECT_LT(top, -17.5);
  EXPECT_NEAR(static_cast<double>(s.sets.at("right").size()), 20, 4);
}

TEST(Sheet, CellsOfTheirOwnThickness) {
  const Tessellation plan = cells(20, 16, 2);
  SheetSection section;
  section.thickness = 2, section.mid_plane = 2 * (0.5 - 0.9);  // floats at 0.9 of its thickness
  std::vector<double> thickness;
  for (const auto& [x, y] : plan.generators) thickness.push_back(1 + 0.03 * x - 0.02 * y);
  const Lattice s = make_sheet(plan, section, thickness);
  for (std::int32_t k = 0; k < s.bodies.size(); ++k) {
    const double h = thickness[static_cast<std::size_t>(k)];
    EXPECT_NEAR(s.bodies.position[k][2], h * (0.5 - 0.9), 1e-15);
    EXPECT_NEAR(s.bodies.mass[k] / (section.ice.density * h),
                plan_properties(polygon(plan, k)).area, 1e-12);
    const VolumeProperties of = volume_properties(s.shapes, k);
    EXPECT_NEAR(of.volume, plan_properties(polygon(plan, k)).area * h, 1e-12);
  }
  ASSERT_EQ(s.beams.offsets.size(), s.beams.bodies.size());
  for (std::size_t m = 0; m < s.beams.bodies.size(); ++m) {
    const auto [i, j] = s.beams.bodies[m];
    // All floats at the same part of its thickness, so the thinner face is the common part.
    const double h = std::min(thickness[i], thickness[j]), w = s.beams.width[m];
    EXPECT_NEAR(s.beams.height[m], h, 1e-15);
    EXPECT_NEAR(s.beams.area[m], w * h, 1e-14);
    EXPECT_NEAR(s.beams.inertia_y[m], w * h * h * h / 12, 1e-14);
    EXPECT_NEAR(s.bodies.position[i][2] + s.beams.offsets[m][0].z, -0.4 * h, 1e-14);
    EXPECT_NEAR(s.bodies.position[j][2] + s.beams.offsets[m][1].z, -0.4 * h, 1e-14);
  }
  // Where mid-planes are level, nothing is eccentric.
  section.mid_plane = 0;
  EXPECT_TRUE(make_sheet(plan, section, thickness).beams.offsets.empty());
}

TEST(Sheet, CellsOfOneThicknessAreTheUniformSheetBitForBit) {
  const Tessellation plan = cells(20, 16, 2);
  SheetSection section;
  section.thickness = 1.3, section.mid_plane = 1.3 * (0.5 - 0.91);
  const Lattice a = make_sheet(plan, section),
                b = make_sheet(plan, section, std::vector<double>(plan.generators.size(), 1.3));
  EXPECT_EQ(a.bodies.mass, b.bodies.mass);
  EXPECT_EQ(a.bodies.inertia, b.bodies.inertia);
  EXPECT_EQ(a.beams.area, b.beams.area);
  EXPECT_EQ(a.beams.inertia_y, b.beams.inertia_y);
  EXPECT_EQ(a.beams.torsion, b.beams.torsion);
  EXPECT_EQ(a.beams.length, b.beams.length);
  EXPECT_EQ(a.shapes.vertices, b.shapes.vertices);
  EXPECT_TRUE(b.beams.offsets.empty());
  for (std::size_t k = 0; k < a.bodies.position.size(); ++k)
    EXPECT_NEAR(a.bodies.position[k].z, b.bodies.position[k].z, 1e-15);
}

TEST(Cut, RemovesTheBeamsThatCross) {
  Lattice s = make_sheet(cells(20, 20, 2), {});
  const Lattice whole = s;
  s.beams.shear_factor_y = s.beams.length;
  cut(s, {0, -10}, {0, 10});
  EXPECT_EQ(s.beams.shear_factor_y, s.beams.length);
  std::size_t crossing = 0;
  for (const auto& [i, j] : whole.beams.bodies)
    crossing += (whole.bodies.position[i][0] < 0) != (whole.bodies.position[j][0] < 0);
  EXPECT_EQ(whole.beams.bodies.size() - s.beams.bodies.size(), crossing);
  EXPECT_GT(crossing, 8u);
  for (const auto& [i, j] : s.beams.bodies)
    EXPECT_EQ(s.bodies.position[i][0] < 0, s.bodies.position[j][0] < 0);
  EXPECT_EQ(s.beams.area.size(), s.beams.bodies.size());
  EXPECT_EQ(s.beams.width.size(), s.beams.bodies.size());
}

TEST(Cut, EndsWhereTheSawStops) {
  Lattice s = make_sheet(cells(20, 20, 2), {});
  const auto before = s.beams.size();
  cut(s, {0, -10}, {0, 0});
  std::int32_t beyond = 0;
  for (const auto& [i, j] : s.beams.bodies) {
    const Point3 &a = s.bodies.position[i], &b = s.bodies.position[j];
    if ((a[0] < 0) == (b[0] < 0)) continue;
    const double y = a[1] + (b[1] - a[1]) * a[0] / (a[0] - b[0]);
    EXPECT_GT(y, 0);
    ++beyond;
  }
  EXPECT_GT(beyond, 3);
  EXPECT_LT(s.beams.size(), before);
  cut(s, {100, 0}, {100, 1});  // misses
  cut(s, {1, 1}, {1, 1});      // a point
  EXPECT_GT(s.beams.size(), before - 20);
}

TEST(Region, IsTheBodiesInTheBox) {
  Lattice s = make_sheet(cells(20, 20, 2), {});
  add_region(s, "patch", {-5, 5, -3, 20, -1, 1}, "region_patch_box");
  const auto& set = s.sets.at("patch");
  std::size_t expected = 0;
  for (const auto& x : s.bodies.position) expected += std::abs(x[0]) <= 5 && x[1] >= -3;
  EXPECT_EQ(set.size(), expected);
  EXPECT_TRUE(std::is_sorted(set.begin(), set.end()));
  EXPECT_THROW(add_region(s, "none", {50, 60, 0, 1, -1, 1}, "region_none_box"), InputError);
  EXPECT_THROW(add_region(s, "left", {-5, 5, -5, 5, -1, 1}, "region_left_box"), InputError);
}

}  // namespace
}  // namespace floe
