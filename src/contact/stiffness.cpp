#include "contact/stiffness.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace floe {

PairConstants pair_constants(const Solids& solids, const ContactOptions& options,
                             const Pair& pair) {
  const double size = solids.size(pair.a), mass = solids.mass(pair.a);
  if (is_obstacle(pair.b))
    return {.stiffness = options.young / (0.5 * size),
            .area = size * size,
            .mass = mass,
            .friction = solids.obstacle(pair.b).friction,
            .half_space = solids.is_half_space(pair.b)};
  const double other_size = solids.size(pair.b), other_mass = solids.mass(pair.b);
  const double smaller = std::min(size, other_size);
  return {.stiffness = options.young / (0.5 * (size + other_size)),
          .area = smaller * smaller,
          .mass = mass * other_mass / (mass + other_mass),
          .friction = options.friction,
          .half_space = false};
}

ContactRates contact_rates(const Solids& solids, const ContactOptions& options,
                           const ContactLaws& law) {
  // L of the partner with the stiffest contacts: the smallest body, or 0 for an obstacle.
  double smallest = solids.obstacles().empty() ? std::numeric_limits<double>::max() : 0.0;
  for (std::int32_t b = 0; b < solids.bodies(); ++b)
    smallest = std::min(smallest, 0.5 * solids.size(b));
  double most = 0;
  for (std::int32_t b = 0; b < solids.bodies(); ++b) {
    const double size = solids.size(b);
    const Solids::Faces& faces = solids.faces(b);
    const double k = options.young / (0.5 * size + smallest);
    const double steeper =
        std::visit([&](const auto& of) { return of.steepness(faces.widest, size * size); }, law);
    most = std::max(most, 2 * k * steeper * faces.area / solids.mass(b));
  }
  return {.stiffness = most, .damping = 4 * options.damping_ratio * std::sqrt(most)};
}

}  // namespace floe
