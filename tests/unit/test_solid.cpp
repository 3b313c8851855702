// Convex parts of solids: their number, volume and place against the solids themselves.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "floe/base/item.h"
#include "floe/base/petsc.h"
#include "geometry/overlap.h"
#include "solid/coarse_hull.h"
#include "solid/convex_parts.h"
#include "solid/hull_distance.h"
#include "solid/predicates.h"
#include "solid/triangle_tree.h"
#include "support/random.h"
#include "support/solids.h"

namespace floe::test {
namespace {

std::span<const Point3> vertices_of(const Shapes& shapes, std::int32_t body) {
  return {shapes.vertices.data() + item(shapes.vertex_of, body),
          shapes.vertices.data() + item(shapes.vertex_of, body + 1)};
}

/// Sum of the volumes that two parts share [m^3].
double common_volume(const Shapes& shapes) {
  Clipper clipper;
  double sum = 0;
  for (std::int32_t b = 0; b < shapes.bodies(); ++b) {
    std::vector<HalfSpace> planes;
    append_half_spaces(shapes, b, planes);
    for (std::int32_t a = 0; a < b; ++a)
      sum += clipper.overlap(shapes, a, vertices_of(shapes, a), planes).volume;
  }
  return sum;
}

/// Number of times that a closed surface winds around a point, by solid angles.
double winding(const Surface& surface, const Point3& point) {
  double half_angle = 0;
  for (const auto& [i, j, k] : surface.triangles) {
    const Point3 a = item(surface.vertices, i) - point, b = item(surface.vertices, j) - point,
                 c = item(surface.vertices, k) - point;
    half_angle +=
        std::atan2(dot(a, cross(b, c)), length(a) * length(b) * length(c) + dot(a, b) * length(c) +
                                            dot(b, c) * length(a) + dot(c, a) * length(b));
  }
  return half_angle / (2 * std::numbers::pi);
}

/// Distance of a point beyond the faces of a part; < 0 inside [m].
double beyond(const Shapes& shapes, std::int32_t body, const Point3& point) {
  std::vector<HalfSpace> planes;
  append_half_spaces(shapes, body, planes);
  double most = -1e300;
  for (const HalfSpace& h : planes) most = std::max(most, dot(h.normal, point) - h.offset);
  return most;
}

struct Case {
  std::string name;
  Surface surface;
  double volume;
  int most;   ///< parts
  int faces;  ///< 0: any number
};

std::vector<Case> cases() {
  const double hollow = 0.5 * 12 * std::sin(2 * std::numbers::pi / 12) * (4 - 1) * 0.5;
  std::vector<Case> all{
      {"box", box(2, 3, 4), 24, 1, 6},
      {"L", l_shape(), 6, 2, 12},
      {"U", u_shape(), 7.5, 3, 18},
      {"box with a hole", ring(4, 1, 2, 0.5), 3, 4, 24},
      {"ring", ring(12, 1, 2, 0.5), hollow, 12, 0},
      {"bowl", bowl(12, 4, 0.8, 1), volume_of(bowl(12, 4, 0.8, 1)), 72, 0},
  };
  Surface two = box(1, 1, 1);
  add(two, box(1, 2, 1), {1.5, 0, 0});
  all.push_back({"two boxes", two, 3, 2, 12});
  const std::size_t n = all.size();
  for (std::size_t k = 0; k < n; ++k) {
    all.push_back(all[k]);
    all.back().name += ", turned";
    all.back().surface = turned(all[k].surface);
  }
  return all;
}

TEST(Solid, PartsAreTheSolid) {
  std::mt19937 random(1);
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.name);
    check_surface(c.surface, "case");
    const ConvexParts parts = convex_parts(c.surface, 0, 1000, "case");
    const Shapes& shapes = parts.shapes;
    EXPECT_LE(shapes.bodies(), c.most);
    EXPECT_TRUE(c.faces == 0 || c.faces == shapes.face_of.back()) << shapes.face_of.back();
    EXPECT_EQ(parts.triangles, static_cast<std::int64_t>(c.surface.triangles.size()));
    EXPECT_NEAR(parts.volume, c.volume, 1e-12 * c.volume);
    EXPECT_NEAR(parts.parts_volume, c.volume, 1e-12 * c.volume);
    EXPECT_EQ(parts.distance, 0);
    EXPECT_LE(common_volume(shapes), 1e-10 * c.volume);
    for (std::int32_t b = 0; b < shapes.bodies(); ++b) {
      EXPECT_FALSE(open_edge(shapes, b));
      EXPECT_GT(volume_properties(shapes, b).volume, 0);
      EXPECT_LT(concavity(shapes, b), 1e-9);
    }
    Point3 low = c.surface.vertices[0], high = low;
    for (const Point3& p : c.surface.vertices) {
      for (std::size_t i = 0; i < 3; ++i) {
        low[i] = std::min(low[i], p[i]);
        high[i] = std::max(high[i], p[i]);
      }
    }
    const TriangleTree tree(c.surface);
    int inside = 0, compared = 0;
    while (compared < 300) {
      Point3 p{};
      for (std::size_t i = 0; i < 3; ++i)
        p[i] = std::uniform_real_distribution(low[i], high[i])(random);
      if (tree.nearest(p).distance < 1e-6) continue;
      double least = 1e300;
      for (std::int32_t b = 0; b < shapes.bodies(); ++b)
        least = std::min(least, beyond(shapes, b, p));
      const bool in_solid = winding(c.surface, p) > 0.5;
      EXPECT_EQ(in_solid, least < 1e-9) << p.x << ' ' << p.y << ' ' << p.z;
      inside += in_solid ? 1 : 0;
      ++compared;
    }
    EXPECT_GT(inside, 20);
  }
}

/// Every vertex of a cut is in the plane of a face of both sides: faces between parts of a ring
/// are found to rounding.
TEST(Solid, NeighboursShareTheirPlanes) {
  const ConvexParts parts = convex_parts(turned(l_shape()), 0, 10, "case");
  ASSERT_EQ(parts.shapes.bodies(), 2);
  std::vector<HalfSpace> one, other;
  append_half_spaces(parts.shapes, 0, one);
  append_half_spaces(parts.shapes, 1, other);
  int shared = 0;
  for (const HalfSpace& h : one)
    for (const HalfSpace& g : other)
      if (length(h.normal + g.normal) < 1e-12 && std::abs(h.offset + g.offset) < 1e-12) ++shared;
  EXPECT_EQ(shared, 1);
}

TEST(Solid, ToleranceFillsDents) {
  // A slot of width 1 and depth 1: its hull is 1 m from its bottom, 0.5 m from its sides.
  const Surface solid = u_shape();
  EXPECT_EQ(convex_parts(solid, 0.1, 1000, "U").shapes.bodies(), 3);
  EXPECT_LE(convex_parts(solid, 0.49, 1000, "U").shapes.bodies(), 3);
  EXPECT_GE(convex_parts(solid, 0.49, 1000, "U").shapes.bodies(), 2);
  const ConvexParts filled = convex_parts(solid, 0.51, 1000, "U");
  EXPECT_EQ(filled.shapes.bodies(), 1);
  EXPECT_NEAR(filled.parts_volume, 9, 1e-12);
  EXPECT_GT(filled.distance, 0.45);
  EXPECT_LT(filled.distance, 0.500001);
}

TEST(Solid, HullDistanceIsThatOfADent) {
  for (const double depth : {0.01, 0.2}) {  // a wedge-shaped notch across a box, 2 m wide
    const Surface solid =
        prism({{0, 0}, {4, 0}, {4, 1}, {3, 1}, {2, 1 - depth}, {1, 1}, {0, 1}}, 1);
    // the middle of the opening from the flanks
    const double exact = depth / std::hypot(depth, 1.0);
    const double found = hull_distance(convex_hull(solid.vertices), solid, 1.001 * exact, 1e-12);
    EXPECT_NEAR(found, exact, 1e-3 * exact);
    EXPECT_GT(hull_distance(convex_hull(solid.vertices), solid, 0.9 * exact, 1e-12), 0.9 * exact);
  }
}

TEST(Solid, CurvedWithinATolerance) {
  const Surface solid = torus(50, 20, 2, 0.6);  // 2,000 triangles
  check_surface(solid, "torus");
  const ConvexParts parts = convex_parts(solid, 0.1, 1000, "torus");
  EXPECT_EQ(parts.triangles, 2000);
  EXPECT_LE(parts.shapes.bodies(), 24);
  EXPECT_GE(parts.shapes.bodies(), 8);
  EXPECT_NEAR(parts.parts_volume, parts.volume, 0.1 * parts.volume);
  EXPECT_LE(parts.distance, 0.1);
  EXPECT_LE(common_volume(parts.shapes), 1e-10 * parts.volume);
  // No vertex of the solid is farther from all parts than the tolerance.
  for (const Point3& p : solid.vertices) {
    double least = 1e300;
    for (std::int32_t b = 0; b < parts.shapes.bodies(); ++b)
      least = std::min(least, beyond(parts.shapes, b, p));
    EXPECT_LE(least, 0.1);
  }
}

/// A ball of many triangles loses vertices until the rest is just within the tolerance, the same in
/// all eight octants.
TEST(Solid, HullsLoseVerticesWithinTheTolerance) {
  Surface ball;
  test::Random random(5);
  std::vector<Point3> points;
  for (int k = 0; k < 150; ++k) {
    const Vec3<double> p = random.direction();
    for (const double x : {1.0, -1.0})
      for (const double y : {1.0, -1.0})
        for (const double z : {1.0, -1.0}) points.push_back({x * p.x, y * p.y, z * p.z});
  }
  ball = convex_hull(points);
  std::size_t before = ball.vertices.size();
  for (const double tolerance : {0.01, 0.03, 0.1}) {
    double distance = 0;
    const Surface coarse = coarse_hull(ball, {}, tolerance, 1e-9, distance);
    EXPECT_LT(coarse.vertices.size(), before);
    before = coarse.vertices.size();
    EXPECT_LE(distance, tolerance);
    EXPECT_GT(distance, 0.2 * tolerance);
    for (const Point3& p : coarse.vertices)
      for (std::size_t axis = 0; axis < 3; ++axis) {
        Point3 mirrored = p;
        mirrored[axis] = -p[axis];
        EXPECT_TRUE(std::find(coarse.vertices.begin(), coarse.vertices.end(), mirrored) !=
                    coarse.vertices.end());
      }
  }
  // Faces between parts stay: vertices in a kept plane are all there.
  double distance = 0;
  const HalfSpace plane{{1, 0, 0}, 0};
  Surface half = convex_hull(points);
  std::erase_if(half.vertices, [](const Point3& p) { return p.x < 0; });
  for (const Point3& p : points) half.vertices.push_back({0, p.y, p.z});
  half = convex_hull(half.vertices);
  const auto in_plane = [](const Surface& s) {
    return std::count_if(s.vertices.begin(), s.vertices.end(),
                         [](const Point3& p) { return std::abs(p.x) < 1e-9; });
  };
  EXPECT_EQ(in_plane(coarse_hull(half, std::span(&plane, 1), 0.1, 1e-9, distance)), in_plane(half));
}

/// Two hooks in each other's bays: the hulls overlap, so a tolerance must not make parts of them.
TEST(Solid, HullsOfSeparateSolidsDoNotOverlap) {
  Surface solid = u_shape();
  add(solid, box(0.4, 0.4, 1.5), {1.3, 1.3, 0});
  check_surface(solid, "hooks");
  const ConvexParts parts = convex_parts(solid, 0.6, 100, "hooks");
  EXPECT_LE(common_volume(parts.shapes), 1e-10 * parts.volume);
  const ConvexParts exact = convex_parts(solid, 0, 100, "hooks");
  EXPECT_EQ(exact.shapes.bodies(), 4);
  EXPECT_NEAR(exact.parts_volume, 7.5 + 0.24, 1e-11);
}

TEST(Solid, TooManyPartsAreRefused) {
  try {
    convex_parts(ring(12, 1, 2, 0.5), 0, 7, "contact: file: 'ring.stl'");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()),
              "contact: file: 'ring.stl': needs more than 7 convex parts at a tolerance of 0 m; a "
              "larger tolerance gives fewer");
  }
}

TEST(Solid, SameBitsTwice) {
  const Surface solid = turned(ring(12, 1, 2, 0.5));
  const ConvexParts one = convex_parts(solid, 0, 100, ""), other = convex_parts(solid, 0, 100, "");
  EXPECT_TRUE(one.shapes.vertices == other.shapes.vertices);
  EXPECT_EQ(one.shapes.corners, other.shapes.corners);
  EXPECT_EQ(one.shapes.face_of, other.shapes.face_of);
}

}  // namespace
}  // namespace floe::test
