// Bodies of several convex parts: their parts, and the area of what they cover.

#include <gtest/gtest.h>

#include <cmath>

#include "geometry/append_faces.h"
#include "geometry/connected_parts.h"
#include "support/blocks.h"

namespace floe {
namespace {

/// Two boxes that meet in a face, as one body.
Shapes two_boxes() {
  Shapes low, high, body;
  test::append_box(low, 1, 1, 1);
  test::append_box(high, 2, 1, 0.5);
  append_faces(body, low);
  append_faces(body, high, {0.5, 0, 0.75});
  body.face_of.push_back(static_cast<std::int32_t>(body.corner_of.size()) - 1);
  body.vertex_of.push_back(static_cast<std::int32_t>(body.vertices.size()));
  return body;
}

TEST(ConnectedParts, AreTheBoxesOfABody) {
  Shapes shapes;
  test::append_box(shapes, 3, 3, 3);
  append_bodies(shapes, two_boxes());
  EXPECT_EQ(number_of_parts(shapes, 0), 1);
  EXPECT_EQ(number_of_parts(shapes, 1), 2);
  EXPECT_EQ(connected_parts(shapes, 0).bodies(), 1);
  const Shapes parts = connected_parts(shapes, 1);
  ASSERT_EQ(parts.bodies(), 2);
  EXPECT_NEAR(volume_properties(parts, 0).volume, 1, 1e-14);
  EXPECT_NEAR(volume_properties(parts, 1).volume, 1, 1e-14);
  EXPECT_NEAR(volume_properties(parts, 1).centroid.x, 0.5, 1e-14);
  EXPECT_NEAR(volume_properties(parts, 1).centroid.z, 0.75, 1e-14);
}

TEST(ConnectedParts, AreaOfAUnionCountsWhatOverlapsOnce) {
  const std::vector<Point2> square{{0, 0}, {1, 0}, {1, 1}, {0, 1}},
      shifted{{0.5, 0.25}, {1.5, 0.25}, {1.5, 1.25}, {0.5, 1.25}}, apart{{3, 0}, {4, 0}, {3, 2}};
  EXPECT_NEAR(area_of_union({square}), 1, 1e-14);
  EXPECT_NEAR(area_of_union({square, square}), 1, 1e-14);
  EXPECT_NEAR(area_of_union({square, shifted}), 2 - 0.5 * 0.75, 1e-14);
  EXPECT_NEAR(area_of_union({square, shifted, apart}), 2 - 0.5 * 0.75 + 1, 1e-14);
  // Two squares of side 2, one turned by 45 degrees: beyond each side of the first one there is a
  // tip of the other, a right triangle of height sqrt 2 - 1.
  const double h = std::sqrt(2.0), tip = (h - 1) * (h - 1);
  EXPECT_NEAR(
      area_of_union({{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}, {{0, -h}, {h, 0}, {0, h}, {-h, 0}}}),
      4 + 4 * tip, 1e-13);
}

}  // namespace
}  // namespace floe
