/// \file
/// Distances of points from a surface.
#pragma once

#include <cstdint>
#include <vector>

#include "solid/surface.h"

namespace floe {

/// Returns the distance of a point from the triangle a b c, which may have no area (Ericson,
/// Real-Time Collision Detection, 2005, section 5.1.5) [m].
double distance(const Point3& point, const Point3& a, const Point3& b, const Point3& c);

/// The triangles of a surface in a tree of boxes around them.
class TriangleTree {
 public:
  explicit TriangleTree(const Surface& surface);

  struct Nearest {
    double distance = 0;  ///< [m]
    std::int32_t triangle = 0;
  };
  /// Returns the triangle nearest to a point.
  Nearest nearest(const Point3& point) const;
  /// Returns the distance of a point from triangle `t` [m].
  double distance_from(std::int32_t t, const Point3& point) const;

 private:
  struct Node {
    Point3 low, high;
    std::int32_t first, end;  ///< of order_
    std::int32_t right;       ///< the left child follows its parent; -1: a leaf
  };
  void build(std::int32_t first, std::int32_t end);
  double box_distance2(const Node& node, const Point3& point) const;

  const Surface& surface_;
  std::vector<std::int32_t> order_;
  std::vector<Node> nodes_;
};

}  // namespace floe
