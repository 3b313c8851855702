// Obstacles are where and what their numbers say: volume and centroid of what each has in common
// with a box around it.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "floe/contact/obstacle.h"
#include "support/blocks.h"

namespace floe {
namespace {

/// What an obstacle at time 0 has in common with a cube of 40 m about the origin.
Overlap inside_of(const Obstacle& o) {
  Shapes cube;
  test::append_box(cube, 40, 40, 40);
  Clipper clipper;
  Overlap common = clipper.overlap(cube, 0, test::placed(cube, 0, {1, 0, 0, 0}, -1.0 * o.point),
                                   o.parts[0].planes);
  common.centroid = common.centroid + o.point;
  return common;
}

void expect_at(const Vec3<double>& a, const Vec3<double>& b) {
  EXPECT_NEAR(a.x, b.x, 1e-12);
  EXPECT_NEAR(a.y, b.y, 1e-12);
  EXPECT_NEAR(a.z, b.z, 1e-12);
}

/// Largest distance of a vertex along each axis.
Vec3<double> reach(const Obstacle& o) {
  Vec3<double> most{};
  for (const auto& v : o.parts[0].vertices)
    most = {std::max(most.x, v.x), std::max(most.y, v.y), std::max(most.z, v.z)};
  return most;
}

TEST(Obstacle, HalfSpaceFillsTheSideThatItsNormalPointsAwayFrom) {
  const Obstacle o = half_space({0, 0, 5}, {0, 0, -3});
  EXPECT_NEAR(inside_of(o).volume, 40 * 40 * 15, 1e-9);
  expect_at(inside_of(o).centroid, {0, 0, 12.5});
}

TEST(Obstacle, BoxTurnsAboutXThenYThenZ) {
  const Obstacle o = box({1, 2, 3}, {2, 4, 6}, {90, 0, 90});
  EXPECT_NEAR(inside_of(o).volume, 48, 1e-12);
  expect_at(inside_of(o).centroid, {1, 2, 3});
  // 2 x 4 x 6 becomes 2 x 6 x 4 about x, then 6 x 2 x 4 about z; z before x makes it 4 x 6 x 2.
  expect_at(reach(o), {3, 1, 2});
  // By 30 degrees about y the x axis dips.
  const Obstacle tilted = box({0, 0, 0}, {2, 1e-3, 1e-3}, {0, 30, 0});
  const auto& corners = tilted.parts[0].vertices;
  const auto east = std::max_element(corners.begin(), corners.end(),
                                     [](const auto& a, const auto& b) { return a.x < b.x; });
  EXPECT_NEAR(east->z, -0.5, 1e-3);
}

TEST(Obstacle, ConesAndCylindersStandOnTheirBase) {
  const double pi = std::numbers::pi;
  for (const int n : {3, 4, 24}) {
    const double polygon = 0.5 * n * std::sin(2 * pi / n);  // over the radius squared
    const Overlap leg = inside_of(cone({1, -2, -3}, 2, 2, 5, n));
    EXPECT_NEAR(leg.volume, polygon * 4 * 5, 1e-11) << n;
    expect_at(leg.centroid, {1, -2, -0.5});
    const Overlap frustum = inside_of(cone({1, -2, -3}, 4, 2, 6, n));
    EXPECT_NEAR(frustum.volume, polygon * 6 * (16 + 8 + 4) / 3, 1e-11) << n;
    expect_at(frustum.centroid, {1, -2, -3 + 6.0 / 4 * (16 + 2 * 8 + 3 * 4) / (16 + 8 + 4)});
    const Overlap pyramid = inside_of(cone({1, -2, -3}, 4, 0, 6, n));
    EXPECT_NEAR(pyramid.volume, polygon * 16 * 6 / 3, 1e-11) << n;
    expect_at(pyramid.centroid, {1, -2, -1.5});
    // A facet looks along x, so that a sheet that comes along x meets a face.
    double farthest = 0;
    const Obstacle cylinder = cone({}, 2, 2, 5, n);
    for (const HalfSpace& h : cylinder.parts[0].planes)
      if (h.normal.x > 1 - 1e-12) farthest = h.offset;
    EXPECT_NEAR(farthest, 2 * std::cos(pi / n), 1e-12);
  }
}

TEST(Obstacle, FromAFileIsWhatTheFileHolds) {
  Lattice one;
  test::append_block(one, {2, 4, 6}, {7, 7, 7});
  const std::string file = "obstacle_of_test.h5";
  write_lattice(one, file);
  const Obstacle o = polyhedra(read_polyhedra(file, "obstacle"), {1, 2, 3});
  std::remove(file.c_str());
  EXPECT_NEAR(inside_of(o).volume, 48, 1e-12);
  expect_at(inside_of(o).centroid, {1, 2, 3});
  expect_at(reach(o), {1, 2, 3});
}

TEST(Shape, MustClose) {
  Shapes s;
  test::append_box(s, 1, 1, 1);
  EXPECT_FALSE(open_edge(s, 0));
  Shapes open = s;
  open.face_of[1] -= 1;  // a side is left out
  EXPECT_TRUE(open_edge(open, 0));
}

TEST(Shape, HasPlaneFaces) {
  Shapes s;
  test::append_box(s, 1, 1, 1);
  EXPECT_LT(concavity(s, 0), 1e-15);
  s.vertices[7] = {0.1, 0.1, 0.1};  // a dent: no vertex is beyond another face
  EXPECT_GT(concavity(s, 0), 0.1);
}

TEST(Obstacle, WayToTheNearestIsInPlan) {
  const Vec3<double> from{1, 2, -0.5};
  EXPECT_EQ(way_to_nearest({}, from), (Vec3<double>{0, 0, 0}));
  const Obstacle leg = cone({11, 2, -8}, 3, 2, 10, 8);
  EXPECT_EQ(way_to_nearest({leg}, from), (Vec3<double>{10, 0, 0}));
  // A slope of 45 degrees through (4, ., -0.5): the straight way leads up by as much.
  const Obstacle slope = half_space({4, 77, -0.5}, {-1, 0, 1});
  const Vec3<double> way = way_to_nearest({leg, slope}, from);
  EXPECT_NEAR(way.x, 1.5, 1e-12);
  EXPECT_NEAR(way.y, 0, 1e-12);
  EXPECT_EQ(way.z, 0);
  EXPECT_EQ(way_to_nearest({leg, half_space({0, 0, -2}, {0, 0, 1})}, from),
            (Vec3<double>{0, 0, 0}));
}

}  // namespace
}  // namespace floe
