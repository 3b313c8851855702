#include "solid/coarse_hull.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "solid/predicates.h"
#include "solid/triangle_tree.h"

namespace floe {
namespace {

/// The vertices that are taken.
class Choice {
 public:
  explicit Choice(const std::vector<Point3>& all) : all_(all), taken_(all.size(), false) {}

  void take(std::size_t k) { taken_[k] = true; }
  /// Takes vertices in the order of some numbers above a least one, those that are not near one
  /// with a larger number that is taken before: nearer than half of the way to those taken earlier.
  void take_largest(const std::vector<double>& of, double least) {
    std::vector<std::size_t> order;
    for (std::size_t k = 0; k < of.size(); ++k)
      if (of[k] > least) order.push_back(k);
    std::sort(order.begin(), order.end(),
              [&](std::size_t a, std::size_t b) { return of[a] != of[b] ? of[a] > of[b] : a < b; });
    std::vector<double> alone;  // squared distance from those taken earlier
    for (const std::size_t k : order) alone.push_back(to_taken(all_[k]));
    constexpr double equal = 1 - 1e-6;
    std::vector<std::size_t> chosen;  // places in `order`
    for (std::size_t n = 0; n < order.size(); ++n) {
      const auto is_covered = [&](std::size_t m) {
        const Vec3<double> apart = all_[order[n]] - all_[order[m]];
        return of[order[n]] < equal * of[order[m]] &&
               dot(apart, apart) < 0.25 * std::min(alone[n], alone[m]);
      };
      if (std::none_of(chosen.begin(), chosen.end(), is_covered)) chosen.push_back(n);
    }
    for (const std::size_t n : chosen) take(order[n]);
  }
  Surface hull() const {
    std::vector<Point3> points;
    for (std::size_t k = 0; k < all_.size(); ++k)
      if (taken_[k]) points.push_back(all_[k]);
    return convex_hull(points);
  }

 private:
  double to_taken(const Point3& p) const {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < all_.size(); ++k)
      if (taken_[k]) least = std::min(least, dot(all_[k] - p, all_[k] - p));
    return least;
  }

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
  for (;;) {
    Surface coarse = choice.hull();
    if (coarse.triangles.empty()) {  // flat so far
      distance = 0;
      return hull;
    }
    // The distance from a convex body is a convex function: it is largest at a vertex.
    const TriangleTree tree(coarse);
    std::vector<double> out;
    for (const Point3& p : all) out.push_back(tree.nearest(p).distance);
    distance = *std::max_element(out.begin(), out.end());
    if (distance <= tolerance) return coarse;
    choice.take_largest(out, tolerance);
  }
}

}  // namespace floe
