#include "solid/hull_distance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <queue>
#include <tuple>
#include <vector>

#include "floe/base/item.h"
#include "solid/triangle_tree.h"

namespace floe {
namespace {

struct Corner {
  Point3 point;
  TriangleTree::Nearest nearest;
};

/// A triangle of the hull or a part of one.
struct Facet {
  std::array<Corner, 3> corners;
  double bound = 0;         ///< of the distance on it [m]
  std::int64_t number = 0;  ///< so that the order of facets is the same everywhere

  bool operator<(const Facet& other) const {
    return std::tie(bound, other.number) < std::tie(other.bound, number);
  }
};

}  // namespace

HullDistance hull_distance(const Surface& hull, const Surface& surface, double tolerance) {
  constexpr std::int64_t most_facets = 300'000;
  const double enough = 0.1 * tolerance;
  const TriangleTree tree(surface);
  const auto corner_at = [&](const Point3& p) { return Corner{p, tree.nearest(p)}; };
  std::int64_t number = 0;
  HullDistance found;
  std::priority_queue<Facet> facets;
  const auto put = [&](const std::array<Corner, 3>& corners) {
    const Corner middle =
        corner_at((1.0 / 3) * (corners[0].point + corners[1].point + corners[2].point));
    double longest = 0, largest = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      longest = std::max(longest, length(corners[(k + 1) % 3].point - corners[k].point));
      largest = std::max(largest, corners[k].nearest.distance);
    }
    // No point of a triangle is farther than that from the nearest corner.
    double bound = largest + longest / std::sqrt(3.0);
    for (const std::int32_t t : {middle.nearest.triangle, corners[0].nearest.triangle,
                                 corners[1].nearest.triangle, corners[2].nearest.triangle}) {
      double from_it = 0;
      for (const Corner& c : corners) from_it = std::max(from_it, tree.distance_from(t, c.point));
      bound = std::min(bound, from_it);
    }
    found.least = std::max({found.least, largest, middle.nearest.distance});
    facets.push({corners, bound, number++});
  };
  for (const auto& [a, b, c] : hull.triangles) {
    put({corner_at(item(hull.vertices, a)), corner_at(item(hull.vertices, b)),
         corner_at(item(hull.vertices, c))});
    if (found.least > tolerance) break;
  }
  while (found.least <= tolerance && facets.top().bound > found.least + enough) {
    if (number > most_facets) {
      found.most = std::numeric_limits<double>::infinity();
      return found;
    }
    const Facet facet = facets.top();
    facets.pop();
    const auto& [a, b, c] = facet.corners;
    const auto between = [&](const Corner& one, const Corner& other) {
      return corner_at(0.5 * (one.point + other.point));
    };
    const Corner ab = between(a, b), bc = between(b, c), ca = between(c, a);
    put({a, ab, ca});
    put({ab, b, bc});
    put({ca, bc, c});
    put({ab, bc, ca});
  }
  found.most = std::max(found.least, facets.top().bound);
  return found;
}

}  // namespace floe
