#include "contact/stiffness.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace floe {

PairConstants pair_constants(const Solids& solids, const ContactOptions& options,
                             const Pair& pair) {
  const double size = solids.size(pair.a);
  if (is_obstacle(pair.b))
    return {.stiffness = options.young / (0.5 * size),
            .area = size * size,
            .friction = solids.obstacle(pair.b).friction,
            .half_space = solids.is_half_space(pair.b)};
  const double other_size = solids.size(pair.b);
  const double smaller = std::min(size, other_size);
  return {.stiffness = options.young / (0.5 * (size + other_size)),
          .area = smaller * smaller,
          .friction = options.friction,
          .half_space = false};
}

ContactRates contact_rates(const Solids& solids, const ContactOptions& options,
                           const ContactLaws& law) {
  // L of the partner with the stiffest contacts: the smallest body, or 0 for an obstacle.
  double smallest = solids.obstacles().empty() ? std::numeric_limits<double>::max() : 0.0;
  for (std::int32_t b = 0; b < solids.bodies(); ++b)
    smallest = std::min(smallest, 0.5 * solids.size(b));
  double most = 0, touch = 0;
  for (std::int32_t b = 0; b < solids.bodies(); ++b) {
    const double size = solids.size(b);
    const Solids::Faces& faces = solids.faces(b);
    const double k = options.young / (0.5 * size + smallest);
    const double steeper =
        std::visit([&](const auto& of) { return of.steepness(faces.widest, size * size); }, law);
    most = std::max(most, 2 * k * steeper * faces.area / solids.mass(b));
    // k_v/m_r is 2 E_c/size/m on an obstacle and between bodies of one size alike; of two sizes the
    // smaller body's own bound holds.
    touch = std::max(touch, 2 * options.young / size * steeper * faces.widest / solids.mass(b));
  }
  // Friction's dashpots are sqrt(0.6) of those along the normal: of six equal faces around a body
  // two damp a motion by their pressure and four by friction, 2 + 4 sqrt(0.6) = sqrt(6) 2.08.
  const double faces = solids.has_friction(options.friction) ? 4.2 : 4.0;
  return {.stiffness = most,
          .damping = faces * options.damping_ratio * std::sqrt(most),
          .touch = touch};
}

}  // namespace floe
