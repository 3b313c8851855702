// The fast clipper against Clipper, and its replays against its full passes. Against exact numbers:
// test_overlap.cpp.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "support/graph_overlap.h"
#include "support/polyhedra.h"
#include "support/random.h"

namespace floe {
namespace {

/// Two bodies and further planes on both, in B's frame.
struct Scene {
  Shapes shapes;  ///< A, then B
  std::vector<HalfSpace> planes, left_of_a, left_of_b;

  /// \param worn  number of further planes on each body
  Scene(test::Random& random, int worn) {
    for (int body = 0; body < 2; ++body) {
      test::append_random(shapes, random, static_cast<int>(random.uniform(0, 6)));
      test::centre_last(shapes);
    }
    append_half_spaces(shapes, 1, planes);
    for (int k = 0; k < worn; ++k) {
      left_of_a.push_back({random.direction(), random.uniform(0.1, 0.6)});
      left_of_b.push_back({random.direction(), random.uniform(0.1, 0.6)});
    }
  }
  double volume() const {
    return std::min(volume_properties(shapes, 0).volume, volume_properties(shapes, 1).volume);
  }
  FurtherPlanes further() const { return {.a = left_of_a, .b = left_of_b}; }
};

/// Expects all numbers of two overlaps to agree to `tolerance` of a body of volume l^3. Of the
/// patch those are compared that do not depend on the choice of its axes u and v.
void expect_agrees(const Overlap& o, const Overlap& r, double l, double tolerance) {
  const double l2 = l * l, l3 = l2 * l;
  EXPECT_NEAR(o.volume, r.volume, tolerance * l3);
  EXPECT_LE(length(o.volume * o.centroid - r.volume * r.centroid), tolerance * l3 * l);
  EXPECT_LE(length(o.area - r.area), tolerance * l2);
  const auto about_origin = [](const Overlap& p) { return p.moment + cross(p.centroid, p.area); };
  EXPECT_LE(length(about_origin(o) - about_origin(r)), tolerance * l3);
  const Patch &p = o.patch, &q = r.patch;
  EXPECT_NEAR(p.area, q.area, tolerance * l2);
  EXPECT_LE(length(p.area * p.middle - q.area * q.middle), tolerance * l3);
  EXPECT_NEAR(p.reach, q.reach, tolerance * l3);
  // S, and so u and v, is well known only where it is not small.
  if (length(r.area) < 1e-3 * l2) return;
  for (const Vec3<double>& e : {q.u, q.v})
    EXPECT_LE(length(p.rocking(e) - q.rocking(e)), tolerance * l2 * l2);
}

TEST(GraphClipper, AgreesWithClipper) {
  test::Random random(21);
  Clipper clipper;
  GraphClipper graph;
  int overlaps = 0;
  for (int k = 0; k < 6000; ++k) {
    const Scene scene(random, k % 3);
    const Quat<double> q = random.rotation(random.uniform(0, 3));
    const Vec3<double> x = random.vector(1.5);
    const test::GraphBody body(scene.shapes, 0);
    CutRecord record;
    const auto o = body.overlap(graph, q, x, scene.planes, record, true, scene.further());
    if (!o) continue;  // no room: for Clipper
    const Overlap r = clipper.overlap(scene.shapes, 0, test::placed(scene.shapes, 0, q, x),
                                      scene.planes, true, scene.further());
    expect_agrees(*o, r, std::cbrt(scene.volume()), 1e-12);
    overlaps += r.volume > 0 ? 1 : 0;
    if (HasFailure()) FAIL() << "pair " << k;
  }
  EXPECT_GT(overlaps, 2000);
}

/// Boxes of which faces lie in faces and edges on edges, exactly or but for rounding.
TEST(GraphClipper, AgreesWithClipperWhereBoxesMeet) {
  test::Random random(22);
  Clipper clipper;
  GraphClipper graph;
  Shapes shapes;
  test::append_box(shapes, 1, 1, 1);
  test::append_box(shapes, 1, 2, 1);
  std::vector<HalfSpace> planes;
  append_half_spaces(shapes, 1, planes);
  const test::GraphBody body(shapes, 0);
  CutRecord record;
  for (int k = 0; k < 5 * 5 * 5 * 12; ++k) {
    const auto place = [](int step) { return 0.25 * (step % 5); };
    const double off = std::pow(10.0, -16.0 + k % 4);
    const Vec3<double> x = Vec3<double>{place(k), place(k / 5), place(k / 25)} +
                           (k % 3 == 0 ? 0 : off) * random.direction();
    const Quat<double> q =
        product(random.rotation(k % 2 == 0 ? 0 : off),
                exp_rotation({0, 0, 0.5 * std::numbers::pi * static_cast<double>(k / 125 % 4)}));
    const auto o = body.overlap(graph, q, x, planes, record);
    ASSERT_TRUE(o);
    const Overlap r = clipper.overlap(shapes, 0, test::placed(shapes, 0, q, x), planes, true);
    EXPECT_NEAR(o->volume, r.volume, 1e-12);
    EXPECT_LE(length(o->volume * o->centroid - r.volume * r.centroid), 1e-12);
  }
}

/// A body that drifts and turns: its record is met by new masks at times. Results of one clipper
/// with a record have the bits of another one that never had one.
TEST(GraphClipper, ReplaysHaveTheBitsOfFullPasses) {
  test::Random random(23);
  GraphClipper with_record, without;
  int replayed = 0, overlaps = 0, other_bits = 0;
  for (int k = 0; k < 200; ++k) {
    Scene scene(random, k % 3);
    const test::GraphBody body(scene.shapes, 0);
    Quat<double> q = random.rotation(random.uniform(0, 3));
    Vec3<double> x = random.vector(0.8);
    const Vec3<double> drift = 5e-4 * random.direction(), spin = 5e-4 * random.direction();
    CutRecord record;
    for (int step = 0; step < 100; ++step) {
      x = x + drift;
      q = product(exp_rotation(spin), q);
      if (step == 50 && !scene.left_of_a.empty()) {  // what is left of bodies changes
        scene.left_of_b.push_back(scene.left_of_a.back());
        scene.left_of_a.pop_back();
      }
      CutRecord fresh;
      const auto o = body.overlap(with_record, q, x, scene.planes, record, true, scene.further());
      const auto r = body.overlap(without, q, x, scene.planes, fresh, true, scene.further());
      ASSERT_EQ(o.has_value(), r.has_value());
      ASSERT_FALSE(without.replayed());
      if (!o) continue;
      ++overlaps;
      replayed += with_record.replayed() ? 1 : 0;
      other_bits += test::same_bits(*o, *r) ? 0 : 1;
    }
  }
  EXPECT_EQ(other_bits, 0);
  EXPECT_GT(replayed, 0.8 * overlaps);
  EXPECT_LT(replayed, overlaps - 200);  // the first of each pair, at least
}

/// An overlap with no vertex of A as apex, and one that is all of A.
TEST(GraphClipper, EdgesThatCrossAndBodiesInside) {
  GraphClipper graph;
  Shapes shapes;
  test::append_box(shapes, 4, 1, 1);
  test::append_box(shapes, 1, 4, 1);
  std::vector<HalfSpace> planes;
  append_half_spaces(shapes, 1, planes);
  const test::GraphBody body(shapes, 0);
  CutRecord record;
  const auto o = body.overlap(graph, {1, 0, 0, 0}, {0, 0, 0.75}, planes, record);
  ASSERT_TRUE(o);
  EXPECT_NEAR(o->volume, 0.25, 1e-15);
  EXPECT_NEAR(o->centroid.z, 0.375, 1e-15);
  EXPECT_NEAR(length(o->area - Vec3<double>{0, 0, 1}), 0, 1e-15);  // B's top; its sides cancel
  EXPECT_NEAR(o->patch.area, 1 + 2 * 0.25, 1e-15);
  test::append_box(shapes, 9, 9, 9);
  planes.clear();
  append_half_spaces(shapes, 2, planes);
  record.cuts = 0;
  const auto all = body.overlap(graph, {1, 0, 0, 0}, {1, 1, 1}, planes, record);
  ASSERT_TRUE(all);
  EXPECT_NEAR(all->volume, 4, 1e-14);
  EXPECT_NEAR(length(all->centroid - Vec3<double>{1, 1, 1}), 0, 1e-14);
  EXPECT_EQ(length(all->area), 0);
}

TEST(EdgeGraph, OfABoxHasTwelveEdgesInClosedFaces) {
  Shapes shapes;
  test::append_box(shapes, 1, 2, 3);
  const auto graph = edge_graph(shapes, 0);
  ASSERT_TRUE(graph);
  EXPECT_EQ(graph->vertices, 8);
  EXPECT_EQ(graph->edges, 12);
  for (std::size_t h = 0; h < 24; ++h) {
    std::size_t g = h;
    for (int corner = 0; corner < 4; ++corner) {
      EXPECT_EQ(graph->origin[graph->next[g]], graph->origin[g ^ 1]);
      g = graph->next[g];
    }
    EXPECT_EQ(g, h);  // faces of four corners
  }
}

TEST(EdgeGraph, IsNothingForLargeOrOpenBodies) {
  const auto prism = [](int sides) {
    std::vector<Point2> polygon;
    for (int k = 0; k < sides; ++k) {
      const double angle = 2 * std::numbers::pi * k / sides;
      polygon.push_back({std::cos(angle), std::sin(angle)});
    }
    Shapes shapes;
    append_prism(shapes, polygon, -0.5, 0.5);
    return shapes;
  };
  EXPECT_TRUE(edge_graph(prism(16), 0));
  EXPECT_FALSE(edge_graph(prism(17), 0));
  Shapes open;
  test::append_body(open, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                    {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}});
  EXPECT_FALSE(edge_graph(open, 0));
}

}  // namespace
}  // namespace floe
