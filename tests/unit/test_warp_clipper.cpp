// Overlaps by the lanes of a warp, as loops on the processor, against those of GraphClipper.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include "device/warp_clipper.h"
#include "support/graph_overlap.h"
#include "support/polyhedra.h"
#include "support/random.h"

namespace floe::device {
namespace {

/// Two bodies, in their own frames.
struct Bodies {
  Shapes shapes;  ///< A, then B
  std::vector<HalfSpace> planes;
  std::vector<double> vertices;  ///< of A

  explicit Bodies(Shapes of) : shapes(std::move(of)) {
    append_half_spaces(shapes, 1, planes);
    for (std::int32_t v = 0; v < shapes.vertex_of[1]; ++v) {
      const Vec3<double>& x = shapes.vertices[static_cast<std::size_t>(v)];
      vertices.insert(vertices.end(), {x.x, x.y, x.z});
    }
  }
  std::optional<Overlap> by_warp(const Quat<double>& q, const Vec3<double>& x,
                                 bool with_patch = true, WarpClipper::Further further = {}) const {
    const std::optional<EdgeGraph> graph = edge_graph(shapes, 0);
    if (!graph) return {};
    ClipRoom room{};
    WarpClipper clipper(Warp{}, room);
    clipper.place(vertices.data(), graph->vertices, triad(q), x);
    Overlap found;
    if (!clipper.overlap(*graph, planes.data(), static_cast<int>(planes.size()), with_patch,
                         further, found))
      return {};
    return found;
  }
  std::optional<Overlap> by_graph(const Quat<double>& q, const Vec3<double>& x) const {
    GraphClipper graph;
    CutRecord record;
    return test::GraphBody(shapes, 0).overlap(graph, q, x, planes, record);
  }
};

/// Expects all numbers to agree to rounding: of the volume, the areas and lengths of the bodies.
void expect_agrees(const Overlap& o, const Overlap& r, double tolerance) {
  EXPECT_NEAR(o.volume, r.volume, tolerance);
  EXPECT_LE(length(o.volume * o.centroid - r.volume * r.centroid), tolerance);
  EXPECT_LE(length(o.area - r.area), tolerance);
  EXPECT_LE(length(o.moment - r.moment), 10 * tolerance);
  const Patch &p = o.patch, &q = r.patch;
  EXPECT_NEAR(p.area, q.area, tolerance);
  EXPECT_LE(length(p.area * p.middle - q.area * q.middle), tolerance);
  if (length(r.area) < 1e-3) return;  // u and v are not well known
  EXPECT_NEAR(p.reach, q.reach, tolerance);
  for (const Vec3<double>& e : {q.u, q.v})
    EXPECT_LE(length(p.rocking(e) - q.rocking(e)), tolerance);
}

TEST(WarpClipper, AgreesWithGraphClipper) {
  test::Random random(31);
  int overlaps = 0, full = 0;
  for (int k = 0; k < 6000; ++k) {
    Shapes shapes;
    for (int body = 0; body < 2; ++body) {
      test::append_random(shapes, random, static_cast<int>(random.uniform(0, 6)));
      test::centre_last(shapes);
    }
    const Bodies bodies(std::move(shapes));
    const Quat<double> q = random.rotation(random.uniform(0, 3));
    const Vec3<double> x = random.vector(1.5);
    const auto o = bodies.by_warp(q, x), r = bodies.by_graph(q, x);
    ASSERT_EQ(o.has_value(), r.has_value());  // both have room, or none
    full += o ? 0 : 1;
    if (!o) continue;
    ASSERT_EQ(o->volume > 0, r->volume > 0) << o->volume << " " << r->volume;
    overlaps += r->volume > 0 ? 1 : 0;
    expect_agrees(*o, *r, 1e-13);
    if (HasFailure()) FAIL() << "pair " << k;
    const Overlap without = *bodies.by_warp(q, x, false);
    EXPECT_EQ(without.volume, o->volume);
    EXPECT_EQ(without.area, o->area);
    EXPECT_EQ(without.moment, o->moment);
    EXPECT_EQ(without.patch.area, 0);
  }
  EXPECT_GT(overlaps, 2000);
  EXPECT_LT(full, 600);
}

/// Bodies of which several corners are cut off: A's by planes in its frame, which bound the overlap
/// without being on B, B's by planes on B.
TEST(WarpClipper, AgreesWhereBodiesAreWorn) {
  test::Random random(33);
  Shapes shapes;
  test::append_box(shapes, 1, 1, 1);
  test::append_box(shapes, 1.2, 1, 0.8);
  const Bodies bodies(std::move(shapes));
  int cut_on_a = 0, cut_on_b = 0;
  for (int k = 0; k < 2000; ++k) {
    const Quat<double> q = random.rotation(random.uniform(0, 3));
    const Vec3<double> x = random.vector(1);
    std::vector<HalfSpace> of_a, of_b, placed_of_a;
    for (int n = 0; n < k % 3; ++n) of_a.push_back({random.direction(), random.uniform(0.2, 0.6)});
    for (int n = 0; n < k % 4; ++n) of_b.push_back({random.direction(), random.uniform(0.2, 0.6)});
    for (const HalfSpace& plane : of_a) placed_of_a.push_back(placed(plane, triad(q), x));
    GraphClipper clipper;
    CutRecord record;
    const auto r =
        test::GraphBody(bodies.shapes, 0)
            .overlap(clipper, q, x, bodies.planes, record, true, {.a = placed_of_a, .b = of_b});
    const auto o = bodies.by_warp(
        q, x, true,
        {of_a.data(), of_b.data(), static_cast<int>(of_a.size()), static_cast<int>(of_b.size())});
    ASSERT_EQ(o.has_value(), r.has_value());
    if (!o) continue;
    ASSERT_EQ(o->volume > 0, r->volume > 0) << k;
    expect_agrees(*o, *r, 1e-13);
    if (HasFailure()) FAIL() << "pair " << k;
    const Overlap whole = *bodies.by_warp(q, x);
    if (of_b.empty() && o->volume > 0 && o->volume < 0.9 * whole.volume) ++cut_on_a;
    if (of_a.empty() && o->volume > 0 && o->volume < 0.9 * whole.volume) ++cut_on_b;
  }
  EXPECT_GT(cut_on_a, 50);
  EXPECT_GT(cut_on_b, 50);
}

/// Boxes of which faces lie in faces and edges on edges, exactly or but for rounding.
TEST(WarpClipper, AgreesWhereBoxesMeet) {
  test::Random random(32);
  Shapes shapes;
  test::append_box(shapes, 1, 1, 1);
  test::append_box(shapes, 1, 2, 1);
  const Bodies bodies(std::move(shapes));
  for (int k = 0; k < 5 * 5 * 5 * 12; ++k) {
    const auto place = [](int step) { return 0.25 * (step % 5); };
    const double off = std::pow(10.0, -16.0 + k % 4);
    const Vec3<double> x = Vec3<double>{place(k), place(k / 5), place(k / 25)} +
                           (k % 3 == 0 ? 0 : off) * random.direction();
    const Quat<double> q =
        product(random.rotation(k % 2 == 0 ? 0 : off),
                exp_rotation({0, 0, 0.5 * std::numbers::pi * static_cast<double>(k / 125 % 4)}));
    const auto o = bodies.by_warp(q, x), r = bodies.by_graph(q, x);
    ASSERT_TRUE(o && r);
    EXPECT_NEAR(o->volume, r->volume, 1e-14);
    EXPECT_LE(length(o->volume * o->centroid - r->volume * r->centroid), 1e-14);
  }
}

/// A corner of a cube that dips into a face: exact numbers.
TEST(WarpClipper, ACornerInAFace) {
  Shapes shapes;
  test::append_box(shapes, 2, 2, 2);
  test::append_box(shapes, 20, 20, 2);
  const Bodies bodies(std::move(shapes));
  const double depth = 0.3, size = std::sqrt(3.0);
  // The diagonal of the cube stands upright.
  const Quat<double> q =
      exp_rotation(std::acos(1 / size) * Vec3<double>{std::sqrt(0.5), -std::sqrt(0.5), 0});
  const auto o = bodies.by_warp(q, {0, 0, 1 + size - depth});
  ASSERT_TRUE(o);
  // Three edges at right angles, each depth sqrt(3) long: V = (sqrt(3) depth)^3/6.
  const double edge = size * depth;
  EXPECT_NEAR(o->volume, edge * edge * edge / 6, 1e-14);
  EXPECT_NEAR(o->area.z, size / 2 * edge * edge, 1e-14);
  EXPECT_NEAR(o->centroid.z, 1 - depth / 4, 1e-14);
}

TEST(WarpClipper, TellsWhatIsBeyondAPlane) {
  Shapes shapes;
  test::append_box(shapes, 2, 2, 2);
  test::append_box(shapes, 2, 2, 2);
  const Bodies bodies(std::move(shapes));
  ClipRoom room{};
  WarpClipper clipper(Warp{}, room);
  clipper.place(bodies.vertices.data(), 8, triad(Quat<double>{1, 0, 0, 0}), {0, 0, 3});
  EXPECT_TRUE(clipper.is_beyond({{0, 0, 1}, 1}, 0.9));
  EXPECT_FALSE(clipper.is_beyond({{0, 0, 1}, 1}, 1.1));
  EXPECT_FALSE(clipper.is_beyond({{1, 0, 0}, 0}, 0));
}

}  // namespace
}  // namespace floe::device
