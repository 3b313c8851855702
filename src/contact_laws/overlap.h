/// \file
/// The contact law `overlap` (model.md, "Contact").
#pragma once

#include "contact_laws/shared_terms.h"

namespace floe {

/// A force k_v (V - V_p) along n at c. Against a half-space it is the buoyancy of a fluid of the
/// weight k_v; between two polyhedra it is not conservative.
struct OverlapLaw {
  static constexpr ContactLaw word = ContactLaw::overlap;
  SharedConstants constants;

  explicit OverlapLaw(const ContactOptions& options) : constants(options) {}

  ContactResponse respond(const ContactState& state, const PairHistory& memory) const {
    const double stiffness = state.pair.stiffness;
    ContactResponse response = elastic_response(
        constants, state, {.rate = stiffness, .root = std::sqrt(stiffness * state.area)}, memory);
    const double plastic = response.contact.memory.plastic;
    const double elastic = state.elastic_volume(plastic);
    response.stored.normal = state.pair.half_space
                                 ? stiffness * stored_volume(state, plastic)
                                 : 0.5 * stiffness * elastic * elastic / state.area;
    return response;
  }

  /// Returns the integral of V - V_p over the depth, from where V was V_p on [m^4]. Without V_p it
  /// is V times the depth of the centroid. Faces, edges and corners have V = (1/p)|S| x for the
  /// deepest point's depth x, p = 1, 2, 3, and the centroid at x/(p + 1); with p of the shape at
  /// hand the integral is exact for them, and its V_p -> 0 is exact for all.
  static double stored_volume(const ContactState& state, double plastic) {
    const double volume = state.overlap.volume, depth = state.depth;
    if (plastic == 0) return volume * depth;
    const double part = plastic / volume;
    if (part >= 1) return 0;
    const double inverse = 1 / depth - state.area / volume;  // 1/x
    if (!(inverse > 0)) return volume * depth * (1 - part) * (1 - part);
    const double deepest = 1 / inverse, power = deepest * state.area / volume;
    const double left = std::pow(part, 1 / power);  // x where V was V_p, over x
    return volume * (depth * (1 - part * left) - part * deepest * (1 - left));
  }

  static double steepness(double /*widest*/, double /*reference*/) { return 1; }
};

}  // namespace floe
