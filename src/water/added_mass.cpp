#include "water/added_mass.h"

#include <cmath>
#include <numbers>

#include "submersion/immersion.h"
#include "water/buoyancy.h"

namespace floe {

std::vector<AddedAlongAxes> added_by_parts(const Part& part, double density,
                                           const std::array<double, 6>& parts) {
  const std::vector<double> displaced = displaced_mass(part, density);
  std::vector<AddedAlongAxes> all;
  for (std::size_t b = 0; b < displaced.size(); ++b) {
    const Point3& inertia = part.bodies.inertia[b];
    const double ratio = displaced[b] / part.bodies.mass[b];
    all.push_back({{parts[0] * displaced[b], parts[1] * displaced[b], parts[2] * displaced[b]},
                   {parts[3] * ratio * inertia.x, parts[4] * ratio * inertia.y,
                    parts[5] * ratio * inertia.z}});
  }
  return all;
}

std::vector<AddedAlongAxes> added_of_plates(const Part& part, double density) {
  (void)displaced_mass(part, density);  // asks for shapes
  const Immersion immersion(part);
  std::vector<AddedAlongAxes> all;
  for (std::int32_t body = 0; body < part.owned; ++body) {
    const auto b = static_cast<std::size_t>(body);
    if (is_dry(part.bodies, body)) {
      all.push_back({});
      continue;
    }
    const double a = std::sqrt(immersion.plan_area(body) / std::numbers::pi);
    const double heave = 4.0 / 3.0 * density * a * a * a;
    const double roll = 8.0 / 45.0 * density * std::pow(a, 5);
    const auto [w, x, y, z] = part.bodies.orientation[b];
    const Triad<double> axes = triad(Quat<double>{w, x, y, z});
    const std::array<double, 3> up{std::abs(axes.e1.z), std::abs(axes.e2.z), std::abs(axes.e3.z)};
    const std::size_t normal = up[2] >= up[0] && up[2] >= up[1] ? 2 : up[1] >= up[0] ? 1 : 0;
    AddedAlongAxes added{{0, 0, 0}, {roll, roll, roll}};
    added.mass[normal] = heave;
    added.moment[normal] = 0;
    all.push_back(added);
  }
  return all;
}

}  // namespace floe
