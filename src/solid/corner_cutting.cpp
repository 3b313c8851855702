#include "solid/corner_cutting.h"

#include <cmath>
#include <cstddef>

#include "floe/base/item.h"

namespace floe {
namespace {

double signed_area(const Point2& a, const Point2& b, const Point2& c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

}  // namespace

std::vector<Surface::Triangle> cut_corners(std::span<const Point3> vertices,
                                           std::vector<std::int32_t> polygon) {
  std::vector<Surface::Triangle> triangles;
  Point3 normal{};
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Point3& o = item(vertices, polygon[0]);
    normal = normal + cross(item(vertices, polygon[k]) - o,
                            item(vertices, polygon[(k + 1) % polygon.size()]) - o);
  }
  std::size_t axis = 0;
  for (std::size_t i = 1; i < 3; ++i)
    if (std::abs(normal[i]) > std::abs(normal[axis])) axis = i;
  const double side = normal[axis] < 0 ? -1 : 1;
  const auto flat = [&](std::int32_t v) {
    const Point3& p = item(vertices, v);
    return Point2{p[(axis + 1) % 3], side * p[(axis + 2) % 3]};
  };
  while (polygon.size() > 3) {
    const std::size_t n = polygon.size();
    const auto corner = [&](std::size_t k) { return polygon[k % n]; };
    const auto is_ear = [&](std::size_t k) {
      const Point2 a = flat(corner(k + n - 1)), b = flat(corner(k)), c = flat(corner(k + 1));
      if (!(signed_area(a, b, c) > 0)) return false;
      for (std::size_t m = k + 2; m < k + n - 1; ++m) {
        const Point2 p = flat(corner(m));
        if (p == a || p == b || p == c) continue;
        if (signed_area(a, b, p) >= 0 && signed_area(b, c, p) >= 0 && signed_area(c, a, p) >= 0)
          return false;
      }
      return true;
    };
    std::size_t ear = 0;
    while (ear < n && !is_ear(ear)) ++ear;
    if (ear == n) ear = 0;  // no simple polygon: the checks of the surface say what is wrong
    triangles.push_back({corner(ear + n - 1), corner(ear), corner(ear + 1)});
    polygon.erase(polygon.begin() + static_cast<std::ptrdiff_t>(ear));
  }
  triangles.push_back({polygon[0], polygon[1], polygon[2]});
  return triangles;
}

}  // namespace floe
