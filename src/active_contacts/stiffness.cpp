#include "active_contacts/stiffness.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace floe {

PairConstants pair_constants(const Solids& solids, const ContactOptions& options, const Pair& pair,
                             bool wet) {
  const double size = solids.size(pair.a);
  const auto at_place = [&](double dry, const std::optional<double>& below) {
    return wet && below ? *below : dry;
  };
  if (is_obstacle(pair.a)) {  // of two obstacles
    const Obstacle &one = solids.obstacle(pair.a), &other = solids.obstacle(pair.b);
    const double other_size = solids.size(pair.b);
    const double smaller = other_size > 0 ? std::min(size, other_size) : size;
    return {.stiffness = options.young / (0.5 * (size + other_size)),
            .area = smaller * smaller,
            .friction = std::max(at_place(one.friction, one.friction_wet),
                                 at_place(other.friction, other.friction_wet)),
            .half_space = solids.is_half_space(pair.b) ? 1.0 : 0.0};
  }
  if (is_obstacle(pair.b)) {
    const Obstacle& obstacle = solids.obstacle(pair.b);
    return {.stiffness = options.young / (0.5 * size),
            .area = size * size,
            .friction = at_place(obstacle.friction, obstacle.friction_wet),
            .half_space = solids.is_half_space(pair.b) ? 1.0 : 0.0};
  }
  const double other_size = solids.size(pair.b);
  const double smaller = std::min(size, other_size);
  const double young = pair.broken && options.young_broken ? *options.young_broken : options.young;
  return {.stiffness = young / (0.5 * (size + other_size)),
          .area = smaller * smaller,
          .friction = at_place(options.friction, options.friction_wet),
          .half_space = 0};
}

ContactRates contact_rates(const Solids& solids, const ContactOptions& options,
                           const ContactLaws& law) {
  // L of the partner with the stiffest contacts: the smallest body, or 0 for an obstacle.
  double smallest = solids.obstacles().empty() ? std::numeric_limits<double>::max() : 0.0;
  double least_size = std::numeric_limits<double>::max();
  for (std::int32_t b = 0; b < solids.bodies(); ++b) {
    if (solids.carries(b)) continue;
    smallest = std::min(smallest, 0.5 * solids.size(b));
    least_size = std::min(least_size, solids.size(b));
  }
  double mobility = 0;  // of the lightest structure
  for (const std::int32_t b : solids.carriers()) mobility = std::max(mobility, 1 / solids.mass(b));
  const double stiffest = std::max(options.young, options.young_broken.value_or(0));
  double most = 0, touch = 0;
  std::int32_t touching = -1;
  for (std::int32_t b = 0; b < solids.bodies(); ++b) {
    // A structure is touched by bodies of any size, all over its surface, and by obstacles.
    const double size = solids.carries(b) ? std::min(least_size, solids.size(b)) : solids.size(b);
    const Solids::Faces& faces = solids.faces(b);
    const double k = stiffest / (0.5 * size + smallest);
    const double steeper =
        std::visit([&](const auto& of) { return of.steepness(faces.widest, size * size); }, law);
    most = std::max(most, 2 * k * steeper * faces.area / solids.mass(b));
    // k_v/m_r is 2 E_c/size/m on an obstacle and between bodies of one size alike; of two sizes the
    // smaller body's own bound holds.
    if (solids.carries(b) && !solids.obstacles_touch()) continue;
    double of_face = 2 * stiffest / size * steeper * faces.widest / solids.mass(b);
    if (mobility > 0 && !solids.carries(b)) of_face *= 1 + mobility * solids.mass(b);
    if (of_face > touch) {
      touch = of_face;
      touching = b;
    }
  }
  // Friction's dashpots are sqrt(0.6) of those along the normal: of six equal faces around a body
  // two damp a motion by their pressure and four by friction, 2 + 4 sqrt(0.6) = sqrt(6) 2.08.
  const double faces = solids.has_friction(options) ? 4.2 : 4.0;
  return {.stiffness = most,
          .damping = faces * options.damping_ratio * std::sqrt(most),
          .touch = touch,
          .touching = touching};
}

}  // namespace floe
