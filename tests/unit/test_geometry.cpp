// Plan and volume properties, and the submerged part of a convex body, against closed forms.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "floe/geometry/polyhedron.h"

namespace floe {
namespace {

/// A vertical prism over a convex polygon, z from low to high.
Shapes prism(const std::vector<Point2>& plan, double low, double high) {
  Shapes s;
  append_prism(s, plan, low, high);
  return s;
}

const std::vector<Point2> pentagon{{-1.2, -0.7}, {0.4, -1.1}, {1.3, 0.1}, {0.5, 0.9}, {-0.9, 0.6}};

/// Rotation about x by a, then y by b, then z by c.
std::array<Point3, 3> rotation(double a, double b, double c) {
  const double ca = std::cos(a), sa = std::sin(a), cb = std::cos(b), sb = std::sin(b);
  const double cc = std::cos(c), sc = std::sin(c);
  return {{{cc * cb, cc * sb * sa - sc * ca, cc * sb * ca + sc * sa},
           {sc * cb, sc * sb * sa + cc * ca, sc * sb * ca - cc * sa},
           {-sb, cb * sa, cb * ca}}};
}

std::vector<Point3> placed(const Shapes& s, const std::array<Point3, 3>& r, const Point3& x) {
  std::vector<Point3> p;
  for (const Point3& v : s.vertices) {
    Point3 q = x;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) q[i] += r[i][j] * v[j];
    p.push_back(q);
  }
  return p;
}

constexpr std::array<Point3, 3> upright{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};

TEST(PlanProperties, RectangleFarFromTheOrigin) {
  const std::vector<Point2> r{{1000, 2000}, {1003, 2000}, {1003, 2001}, {1000, 2001}};
  const PlanProperties p = plan_properties(r);
  EXPECT_DOUBLE_EQ(p.area, 3);
  EXPECT_DOUBLE_EQ(p.centroid[0], 1001.5);
  EXPECT_DOUBLE_EQ(p.centroid[1], 2000.5);
  EXPECT_NEAR(p.xx, 27.0 / 12, 1e-13);
  EXPECT_NEAR(p.yy, 3.0 / 12, 1e-13);
  EXPECT_NEAR(p.xy, 0, 1e-13);
}

TEST(PlanProperties, RightTriangleHasAProductOfInertia) {
  const std::vector<Point2> t{{0, 0}, {2, 0}, {0, 3}};
  const PlanProperties p = plan_properties(t);  // b^3 h/36, b h^3/36, -b^2 h^2/72
  EXPECT_NEAR(p.xx, 8.0 * 3 / 36, 1e-14);
  EXPECT_NEAR(p.yy, 2.0 * 27 / 36, 1e-14);
  EXPECT_NEAR(p.xy, -4.0 * 9 / 72, 1e-14);
}

TEST(PlanProperties, AgreesWithACountOfSmallSquares) {
  const PlanProperties p = plan_properties(pentagon);
  const int n = 1500;
  double area = 0, sx = 0, xx = 0, xy = 0;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      const double x = -1.5 + 3.0 * (i + 0.5) / n, y = -1.5 + 3.0 * (j + 0.5) / n;
      bool inside = true;
      for (std::size_t k = 0; k < pentagon.size(); ++k) {
        const auto &a = pentagon[k], &b = pentagon[(k + 1) % pentagon.size()];
        inside &= (b[0] - a[0]) * (y - a[1]) >= (b[1] - a[1]) * (x - a[0]);
      }
      if (!inside) continue;
      const double u = x - p.centroid[0], v = y - p.centroid[1];
      area += 1, sx += u, xx += u * u, xy += u * v;
    }
  }
  const double cell = 9.0 / n / n;
  EXPECT_NEAR(area * cell, p.area, 1e-3);
  EXPECT_NEAR(sx * cell, 0, 1e-3);
  EXPECT_NEAR(xx * cell, p.xx, 1e-3);
  EXPECT_NEAR(xy * cell, p.xy, 1e-3);
}

TEST(VolumeProperties, PrismFromItsPlan) {
  const double h = 0.8;
  const Shapes s = prism(pentagon, 5, 5 + h);
  const VolumeProperties v = volume_properties(s, 0);
  const PlanProperties p = plan_properties(pentagon);
  EXPECT_NEAR(v.volume, p.area * h, 1e-13);
  EXPECT_NEAR(v.centroid[0], p.centroid[0], 1e-13);
  EXPECT_NEAR(v.centroid[2], 5 + h / 2, 1e-13);
  const double slab = v.volume * h * h / 12;
  const double expected[9]{p.yy * h + slab,  -p.xy * h, 0, -p.xy * h, p.xx * h + slab, 0, 0, 0,
                           (p.xx + p.yy) * h};
  for (int i = 0; i < 9; ++i) EXPECT_NEAR(v.inertia[i], expected[i], 1e-13) << i;
}

TEST(VolumeProperties, RegularTetrahedronIsIsotropic) {
  Shapes s;
  s.vertices = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
  s.corners = {0, 1, 2, 0, 3, 1, 0, 2, 3, 1, 3, 2};
  s.corner_of = {0, 3, 6, 9, 12};
  s.face_of = {0, 4};
  s.vertex_of = {0, 4};
  const VolumeProperties v = volume_properties(s, 0);
  EXPECT_NEAR(v.volume, 8.0 / 3, 1e-14);  // edge a = 2 sqrt 2: V = a^3/(6 sqrt 2), I = V a^2/20
  for (int i = 0; i < 9; ++i)
    EXPECT_NEAR(v.inertia[i], i % 4 == 0 ? 8.0 / 3 * 8 / 20 : 0, 1e-14) << i;
}

TEST(Submerged, TiltedPrismCutOnItsSides) {
  // The formula is that of model.md, "Water": Prisms. The body's frame has its origin at the
  // centroid and the plan's own axes.
  std::vector<Point2> plan = pentagon;
  const PlanProperties p = plan_properties(plan);
  for (auto& q : plan) q = {q[0] - p.centroid[0], q[1] - p.centroid[1]};
  const double h = 2;
  const Shapes s = prism(plan, -h / 2, h / 2);
  const auto r = rotation(0.3, -0.2, 1.1);
  const Point3 x{0.02, -0.05, 0.1};
  const double level = 0.25;
  const auto w = placed(s, r, x);
  const Submerged b = submerged(s, 0, w, level);

  const double bottom = x[2] - r[2][2] * h / 2;
  const double column = (level - bottom) / r[2][2], volume = p.area * column;
  const double sx = r[2][0] / r[2][2], sy = r[2][1] / r[2][2];
  const Point3 centre{
      -(p.xx * sx + p.xy * sy) / volume, -(p.xy * sx + p.yy * sy) / volume,
      -h / 2 + column / 2 + (p.xx * sx * sx + 2 * p.xy * sx * sy + p.yy * sy * sy) / (2 * volume)};
  EXPECT_NEAR(b.volume, volume, 1e-13);
  for (int i = 0; i < 3; ++i) {
    double expected = x[i];
    for (int j = 0; j < 3; ++j) expected += r[i][j] * centre[j];
    EXPECT_NEAR(b.moment[i] / b.volume, expected, 1e-13) << i;
  }
  EXPECT_NEAR(b.waterplane, p.area / r[2][2], 1e-13);
}

TEST(Submerged, WaterplaneIsTheDerivativeOfVolume) {
  // dV/dlevel = waterplane; d(moment)/dlevel has the first moments and level times the area. A
  // corner case of a body on its edge, at many levels.
  const Shapes s = prism(pentagon, -0.5, 0.9);
  const auto w = placed(s, rotation(0.9, 0.5, 0.2), {0.3, 0.1, -0.2});
  const double d = 1e-5;
  for (double level = -1.6; level < 1.6; level += 0.0937) {
    const Submerged below = submerged(s, 0, w, level - d), above = submerged(s, 0, w, level + d);
    const Submerged here = submerged(s, 0, w, level);
    EXPECT_NEAR((above.volume - below.volume) / (2 * d), here.waterplane, 1e-8);
    EXPECT_NEAR((above.moment[0] - below.moment[0]) / (2 * d), here.wx, 1e-8);
    EXPECT_NEAR((above.moment[1] - below.moment[1]) / (2 * d), here.wy, 1e-8);
    EXPECT_NEAR((above.moment[2] - below.moment[2]) / (2 * d), here.waterplane * level, 1e-8);
    EXPECT_GE(here.wxx * here.wyy - here.wxy * here.wxy, -1e-12);
  }
}

TEST(Submerged, WaterplaneMomentsOfAnUprightPrism) {
  const Shapes s = prism(pentagon, -1, 1);
  const PlanProperties p = plan_properties(pentagon);
  const Submerged b = submerged(s, 0, placed(s, upright, {2, -3, 0}), 0.4);
  const double x = p.centroid[0] + 2, y = p.centroid[1] - 3;
  EXPECT_NEAR(b.wx, p.area * x, 1e-12);
  EXPECT_NEAR(b.wy, p.area * y, 1e-12);
  EXPECT_NEAR(b.wxx, p.xx + p.area * x * x, 1e-12);
  EXPECT_NEAR(b.wyy, p.yy + p.area * y * y, 1e-12);
  EXPECT_NEAR(b.wxy, p.xy + p.area * x * y, 1e-12);
}

TEST(Submerged, FullyInFullyOutAndTouching) {
  const Shapes s = prism(pentagon, -1, 1);
  const double volume = 2 * plan_properties(pentagon).area;
  const auto w = placed(s, upright, {0, 0, 0});
  EXPECT_EQ(submerged(s, 0, w, -1.5).volume, 0);
  EXPECT_EQ(submerged(s, 0, w, -1).volume, 0);               // resting on the surface
  EXPECT_NEAR(submerged(s, 0, w, 1).volume, volume, 1e-13);  // top face awash
  const Submerged deep = submerged(s, 0, w, 1e6);
  EXPECT_NEAR(deep.volume, volume, 1e-13);
  EXPECT_EQ(deep.waterplane, 0);
  EXPECT_NEAR(deep.moment[2], 0, 1e-13);
  // One vertex, then one edge, exactly at the level: nothing, and next to nothing, is under water.
  const auto tip = placed(s, rotation(0.7, 0.4, 0), {0, 0, 0});
  double lowest = 1e9;
  for (const auto& v : tip) lowest = std::min(lowest, v[2]);
  EXPECT_EQ(submerged(s, 0, tip, lowest).volume, 0);
  const double sliver = submerged(s, 0, tip, lowest + 1e-9).volume;
  EXPECT_GE(sliver, 0);
  EXPECT_LT(sliver, 1e-24);
}

TEST(Submerged, LevelThroughVertices) {
  // A cube on its corner, cut through three vertices (a triangle, 1/6 of it) and through the middle
  // (a regular hexagon of area 3 sqrt 3 / 4 in a cube of edge 1).
  const Shapes s = prism({{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}}, -0.5, 0.5);
  const auto w =
      placed(s, rotation(std::numbers::pi / 4, std::asin(1 / std::sqrt(3.0)), 0), {0, 0, 0});
  const double third = 1 / (2 * std::sqrt(3.0));
  EXPECT_NEAR(submerged(s, 0, w, -third).volume, 1.0 / 6, 1e-13);
  EXPECT_NEAR(submerged(s, 0, w, third).volume, 5.0 / 6, 1e-13);
  const Submerged half = submerged(s, 0, w, 0);
  EXPECT_NEAR(half.volume, 0.5, 1e-13);
  EXPECT_NEAR(half.waterplane, 3 * std::sqrt(3.0) / 4, 1e-13);
}

bool same(const Shapes& a, const Shapes& b) {
  return a.vertices == b.vertices && a.corners == b.corners && a.corner_of == b.corner_of &&
         a.face_of == b.face_of && a.vertex_of == b.vertex_of;
}

TEST(Prisms, ComeBackAsTheyWere) {
  Shapes shapes;
  append_prism(shapes, pentagon, -0.4, 0.3);
  append_prism(shapes, std::vector<Point2>{{0, 0}, {1, 0}, {0.2, 0.9}}, -0.4, 0.3);
  const std::optional<Prisms> prisms = as_prisms(shapes);
  ASSERT_TRUE(prisms);
  EXPECT_EQ(prisms->corners.size(), 8U);
  EXPECT_TRUE(same(polyhedra(*prisms), shapes));
}

TEST(Prisms, OfOneThicknessOnlyAndNothingElse) {
  EXPECT_FALSE(as_prisms(Shapes{}));
  Shapes shapes = prism(pentagon, -0.4, 0.3);
  append_prism(shapes, pentagon, -0.4, 0.31);
  EXPECT_FALSE(as_prisms(shapes));
  Shapes moved = prism(pentagon, -0.4, 0.3);
  moved.vertices[7][0] += 1e-15;  // its top is not its bottom's plan
  EXPECT_FALSE(as_prisms(moved));
  Shapes turned = prism(pentagon, -0.4, 0.3);
  std::swap(turned.corners[0], turned.corners[1]);
  EXPECT_FALSE(as_prisms(turned));
}

}  // namespace
}  // namespace floe
