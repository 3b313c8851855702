#include "contact/part_faces.h"

#include <algorithm>
#include <cmath>

#include "geometry/across.h"

namespace floe {

std::vector<Vec3<double>> face_in(const ConvexPart& part, const HalfSpace& plane, double near) {
  std::vector<Vec3<double>> corners;
  Vec3<double> middle{};
  for (const Vec3<double>& r : part.vertices) {
    if (std::abs(dot(plane.normal, r) - plane.offset) > near) continue;
    corners.push_back(r);
    middle = middle + r;
  }
  if (corners.size() < 3) return {};
  middle = (1 / static_cast<double>(corners.size())) * middle;
  const auto [u, v] = basis_across(plane.normal);
  const auto angle = [&, u = u, v = v](const Vec3<double>& r) {
    return std::atan2(dot(v, r - middle), dot(u, r - middle));
  };
  std::sort(corners.begin(), corners.end(),
            [&](const Vec3<double>& p, const Vec3<double>& q) { return angle(p) < angle(q); });
  return corners;
}

bool is_same(const HalfSpace& one, const HalfSpace& other, double near) {
  constexpr double turned = 1e-6;
  return length(one.normal - other.normal) < turned && std::abs(one.offset - other.offset) < near;
}

std::vector<HalfSpace> different_planes(const ConvexPart& part, double near) {
  std::vector<HalfSpace> planes;
  for (const HalfSpace& plane : part.planes) {
    if (std::none_of(planes.begin(), planes.end(),
                     [&](const HalfSpace& known) { return is_same(known, plane, near); }))
      planes.push_back(plane);
  }
  return planes;
}

}  // namespace floe
