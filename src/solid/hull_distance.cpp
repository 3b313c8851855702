#include "solid/hull_distance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <queue>
#include <set>
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

using Corners = std::array<Point3, 3>;

Corners corners_of(const Surface& surface, const Surface::Triangle& triangle) {
  return {item(surface.vertices, triangle[0]), item(surface.vertices, triangle[1]),
          item(surface.vertices, triangle[2])};
}

/// Twice the area vector.
Point3 area2(const Corners& c) { return cross(c[1] - c[0], c[2] - c[0]); }

/// A triangle's coordinates from its first corner on, whichever that is in its surface.
std::array<double, 9> key_of(Corners c) {
  const auto before = [](const Point3& p, const Point3& q) {
    return std::tie(p.x, p.y, p.z) < std::tie(q.x, q.y, q.z);
  };
  std::rotate(c.begin(), std::min_element(c.begin(), c.end(), before), c.end());
  return {c[0].x, c[0].y, c[0].z, c[1].x, c[1].y, c[1].z, c[2].x, c[2].y, c[2].z};
}

/// Returns the triangles of the hull that are not on the solid's surface as a whole: neither
/// triangles of it, nor of a plane of which the solid has as much area.
std::vector<Corners> uncovered(const Surface& hull, const Surface& surface, double rounding) {
  std::set<std::array<double, 9>> known;
  for (const Surface::Triangle& t : surface.triangles) known.insert(key_of(corners_of(surface, t)));
  std::vector<Corners> facets;
  for (const Surface::Triangle& t : hull.triangles) facets.push_back(corners_of(hull, t));
  std::vector<bool> seen(facets.size());
  for (std::size_t f = 0; f < facets.size(); ++f) seen[f] = known.contains(key_of(facets[f]));
  std::vector<Corners> found;
  for (std::size_t f = 0; f < facets.size(); ++f) {
    if (seen[f]) continue;
    const Point3 normal = area2(facets[f]);
    const double size = length(normal);
    const auto area_in_plane = [&](const Corners& corners) {
      for (const Point3& p : corners)
        if (std::abs(dot(normal, p - facets[f][0])) > rounding * size) return 0.0;
      return std::max(0.0, dot(area2(corners), normal));
    };
    double of_hull = 0, of_surface = 0;
    std::vector<std::size_t> here;
    for (std::size_t g = 0; g < facets.size(); ++g) {
      const double area = area_in_plane(facets[g]);
      of_hull += area;
      if (area > 0 && !seen[g]) here.push_back(g);
    }
    for (const Surface::Triangle& t : surface.triangles)
      of_surface += area_in_plane(corners_of(surface, t));
    constexpr double nearly = 1 - 1e-9;
    if (of_surface >= nearly * of_hull) {
      for (const std::size_t g : here) seen[g] = true;
    } else {
      found.push_back(facets[f]);
    }
  }
  return found;
}

}  // namespace

double hull_distance(const Surface& hull, const Surface& surface, double tolerance,
                     double rounding) {
  constexpr std::int64_t most_facets = 20'000;
  const TriangleTree tree(surface);
  const auto corner_at = [&](const Point3& p) { return Corner{p, tree.nearest(p)}; };
  std::int64_t number = 0;
  double largest = 0;
  std::priority_queue<Facet> facets;
  const auto put = [&](const std::array<Corner, 3>& corners) {
    const Corner middle =
        corner_at((1.0 / 3) * (corners[0].point + corners[1].point + corners[2].point));
    double longest = 0, at_corners = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      longest = std::max(longest, length(corners[(k + 1) % 3].point - corners[k].point));
      at_corners = std::max(at_corners, corners[k].nearest.distance);
    }
    // No point of a triangle is farther than that from the nearest corner.
    double bound = at_corners + longest / std::sqrt(3.0);
    for (const std::int32_t t : {middle.nearest.triangle, corners[0].nearest.triangle,
                                 corners[1].nearest.triangle, corners[2].nearest.triangle}) {
      double from_it = 0;
      for (const Corner& c : corners) from_it = std::max(from_it, tree.distance_from(t, c.point));
      bound = std::min(bound, from_it);
    }
    largest = std::max({largest, at_corners, middle.nearest.distance});
    facets.push({corners, bound, number++});
  };
  for (const auto& [a, b, c] : uncovered(hull, surface, rounding)) {
    put({corner_at(a), corner_at(b), corner_at(c)});
    if (largest > tolerance) return largest;
  }
  while (largest <= tolerance && !facets.empty() && facets.top().bound > tolerance &&
         number < most_facets) {
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
  return largest;
}

}  // namespace floe
