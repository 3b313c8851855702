/// \file
/// Convex polygons in space.
#pragma once

#include <vector>

#include "floe/base/rotation.h"
#include "floe/geometry/half_space.h"

namespace floe {

/// Cuts a convex polygon by a half-space; what lies on the plane stays. Nothing may be left.
/// \param work  work space
inline void cut(std::vector<Vec3<double>>& polygon, const HalfSpace& plane,
                std::vector<Vec3<double>>& work) {
  work.clear();
  const std::size_t n = polygon.size();
  for (std::size_t k = 0; k < n; ++k) {
    const Vec3<double>&p = polygon[k], &q = polygon[k + 1 < n ? k + 1 : 0];
    const double at_p = dot(plane.normal, p) - plane.offset,
                 at_q = dot(plane.normal, q) - plane.offset;
    if (at_p <= 0) work.push_back(p);
    if ((at_p <= 0) != (at_q <= 0)) work.push_back(p + (at_p / (at_p - at_q)) * (q - p));
  }
  polygon.swap(work);
}

/// Returns the area vector of a polygon, by its corners' right-hand rule [m^2].
inline Vec3<double> area_vector(const std::vector<Vec3<double>>& polygon) {
  Vec3<double> twice{};
  for (std::size_t k = 1; k + 1 < polygon.size(); ++k)
    twice = twice + cross(polygon[k] - polygon[0], polygon[k + 1] - polygon[0]);
  return 0.5 * twice;
}

}  // namespace floe
