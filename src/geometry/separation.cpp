#include "geometry/separation.h"

#include <cmath>
#include <cstddef>
#include <limits>

#include "base/simd.h"

namespace floe {
namespace {

/// Along an axis from B to A: the point of A nearest to B, the point of B nearest to A, and the gap
/// between them [m].
struct Nearest {
  std::size_t a = 0, b = 0;
  double gap = 0;
};

Nearest nearest(std::span<const Vec3<double>> a, std::span<const Vec3<double>> b,
                const Vec3<double>& axis) {
  Nearest n;
  double low = dot(axis, a[0]), high = dot(axis, b[0]);
  for (std::size_t k = 1; k < a.size(); ++k) {
    const double at = dot(axis, a[k]);
    if (at < low) low = at, n.a = k;
  }
  for (std::size_t k = 1; k < b.size(); ++k) {
    const double at = dot(axis, b[k]);
    if (at > high) high = at, n.b = k;
  }
  n.gap = low - high;
  return n;
}

}  // namespace

double lowest_along(const VertexLists& vertices, const Vec3<double>& n) {
  FewLanes lowest = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < vertices.number; k += few_lanes) {
    const auto list = [&](const double* from) {
      return FewLanes(from + k, std::experimental::element_aligned);
    };
    const Vec3<FewLanes> r{list(vertices.x), list(vertices.y), list(vertices.z)};
    lowest = std::experimental::min(lowest, dot(n, r));
  }
  return std::experimental::hmin(lowest);
}

double gap_along(std::span<const Vec3<double>> a, std::span<const Vec3<double>> b,
                 const Vec3<double>& axis) {
  return nearest(a, b, axis).gap;
}

double separate(std::span<const Vec3<double>> a, std::span<const Vec3<double>> b,
                Vec3<double>& axis, int tries) {
  Nearest n = nearest(a, b, axis);
  for (int k = 0; k < tries && n.gap <= 0; ++k) {
    const Vec3<double> apart = a[n.a] - b[n.b];
    const double length2 = dot(apart, apart);
    if (length2 == 0) break;  // a common vertex
    axis = axis - (2 * n.gap / length2) * apart;
    axis = (1 / std::sqrt(dot(axis, axis))) * axis;
    n = nearest(a, b, axis);
  }
  return n.gap;
}

}  // namespace floe
