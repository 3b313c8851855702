#include "solid/coarse_hull.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "floe/base/item.h"
#include "solid/hull_distance.h"
#include "solid/predicates.h"

namespace floe {
namespace {

/// Returns how far each point is beyond the planes of a hull's triangles [m].
std::vector<double> beyond(const std::vector<Point3>& points, const Surface& hull) {
  std::vector<double> most(points.size(), -std::numeric_limits<double>::infinity());
  for (const auto& [a, b, c] : hull.triangles) {
    const Point3& o = item(hull.vertices, a);
    Point3 n = cross(item(hull.vertices, b) - o, item(hull.vertices, c) - o);
    n = (1 / length(n)) * n;
    const double offset = dot(n, o);
    for (std::size_t k = 0; k < points.size(); ++k)
      most[k] = std::max(most[k], dot(n, points[k]) - offset);
  }
  return most;
}

/// The vertices that are taken.
class Choice {
 public:
  explicit Choice(const std::vector<Point3>& all) : all_(all), taken_(all.size(), false) {}

  void take(std::size_t k) { taken_[k] = true; }
  /// Takes all vertices with the largest of some numbers, equal up to rounding.
  void take_largest(const std::vector<double>& of) {
    const double most = *std::max_element(of.begin(), of.end());
    constexpr double rounding = 1e-6;
    for (std::size_t k = 0; k < of.size(); ++k)
      if (of[k] >= most - rounding * std::abs(most)) take(k);
  }
  Surface hull() const {
    std::vector<Point3> points;
    for (std::size_t k = 0; k < all_.size(); ++k)
      if (taken_[k]) points.push_back(all_[k]);
    return convex_hull(points);
  }

 private:
  const std::vector<Point3>& all_;
  std::vector<bool> taken_;
};

}  // namespace

Surface coarse_hull(const Surface& hull, std::span<const HalfSpace> kept, double tolerance,
                    double rounding, double& distance) {
  const std::vector<Point3>& all = hull.vertices;
  Choice choice(all);
  for (const double sign : {1.0, -1.0}) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto along = [&](const Point3& p) { return sign * p[axis]; };
      double most = along(all[0]);
      for (const Point3& p : all) most = std::max(most, along(p));
      for (std::size_t k = 0; k < all.size(); ++k)
        if (along(all[k]) >= most - rounding) choice.take(k);
    }
  }
  for (std::size_t k = 0; k < all.size(); ++k)
    for (const HalfSpace& plane : kept)
      if (std::abs(dot(plane.normal, all[k]) - plane.offset) <= rounding) choice.take(k);
  double allowed = tolerance;
  for (;;) {
    Surface coarse = choice.hull();
    if (coarse.triangles.empty()) {
      distance = 0;
      return hull;
    }
    const std::vector<double> out = beyond(all, coarse);
    const double most = *std::max_element(out.begin(), out.end());
    if (most > allowed) {
      choice.take_largest(out);
      continue;
    }
    // The distance from planes is below that from the hull where several planes count.
    const double found = hull_distance(hull, coarse, tolerance, rounding);
    if (found <= tolerance || most <= rounding) {
      distance = found;
      return coarse;
    }
    allowed = 0.7 * most;
  }
}

}  // namespace floe
