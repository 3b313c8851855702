#include "active_contacts/stiffness.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace floe {

PairConstants pair_constants(const Solids& solids, const ContactOptions& options, const Pair& pair,
                             bool wet) {
  const auto friction_of = [&](const auto& of) {
    return wet && of.friction_wet ? *of.friction_wet : of.friction;
  };
  const double half_space = solids.is_half_space(pair.b) ? 1.0 : 0.0;
  const bool of_ice = solids.is_ice(pair.a), on_ice = solids.is_ice(pair.b);
  if (of_ice != on_ice) {  // ice on an obstacle
    PairConstants of = ice_on_obstacle(options.young, solids.size(of_ice ? pair.a : pair.b));
    of.friction = friction_of(solids.obstacle(of_ice ? pair.b : pair.a));
    of.half_space = half_space;
    return of;
  }
  const double young = pair.broken && options.young_broken ? *options.young_broken : options.young;
  PairConstants of = ice_on_ice(young, solids.size(pair.a), solids.size(pair.b));
  of.friction =
      of_ice ? friction_of(options)
             : std::max(friction_of(solids.obstacle(pair.a)), friction_of(solids.obstacle(pair.b)));
  of.half_space = half_space;
  return of;
}

ContactRates contact_rates(const Solids& solids, const ContactOptions& options,
                           const ContactLaws& law) {
  // L of the partner with the stiffest contacts: the smallest body, or 0 for an obstacle.
  const auto& obstacles = solids.obstacles();
  const bool all_ice =
      std::all_of(obstacles.begin(), obstacles.end(), [](const Obstacle& o) { return o.is_ice; });
  double smallest = all_ice ? std::numeric_limits<double>::max() : 0.0;
  double least_size = std::numeric_limits<double>::max();
  for (std::int32_t b = 0; b < solids.bodies(); ++b) {
    if (solids.is_structure(b)) continue;
    smallest = std::min(smallest, 0.5 * solids.size(b));
    least_size = std::min(least_size, solids.size(b));
  }
  double mobility = 0;  // of the lightest structure
  for (const std::int32_t b : solids.carriers())
    if (solids.is_structure(b)) mobility = std::max(mobility, 1 / solids.mass(b));
  const double stiffest = std::max(options.young, options.young_broken.value_or(0));
  double most = 0, touch = 0;
  std::int32_t touching = -1;
  for (std::int32_t b = 0; b < solids.bodies(); ++b) {
    // A structure is touched by bodies of any size, all over its surface, and by obstacles.
    const double size =
        solids.is_structure(b) ? std::min(least_size, solids.size(b)) : solids.size(b);
    const Solids::Faces& faces = solids.faces(b);
    const double k = stiffest / (0.5 * size + smallest);
    const double steeper =
        std::visit([&](const auto& of) { return of.steepness(faces.widest, size * size); }, law);
    most = std::max(most, 2 * k * steeper * faces.area / solids.mass(b));
    // k_v/m_r is 2 E_c/size/m on an obstacle and between bodies of one size alike; of two sizes the
    // smaller body's own bound holds.
    if (solids.is_structure(b) && !solids.obstacles_touch()) continue;
    double of_face = 2 * stiffest / size * steeper * faces.widest / solids.mass(b);
    if (mobility > 0 && !solids.is_structure(b)) of_face *= 1 + mobility * solids.mass(b);
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
