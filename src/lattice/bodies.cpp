#include "floe/base/rotation.h"
#include "floe/lattice/lattice.h"

namespace floe {

double inertia_about(const Bodies& bodies, std::int32_t body, const Point3& axis) {
  const auto b = static_cast<std::size_t>(body);
  const auto [w, x, y, z] = bodies.orientation[b];
  const Vec3<double> a = triad(Quat<double>{w, x, y, z}).to_local(axis);
  const Point3& inertia = bodies.inertia[b];
  return inertia.x * a.x * a.x + inertia.y * a.y * a.y + inertia.z * a.z * a.z;
}

}  // namespace floe
