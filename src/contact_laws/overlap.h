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
    response.stored.normal = state.pair.half_space && plastic == 0
                                 ? stiffness * state.overlap.volume * state.depth
                                 : 0.5 * stiffness * elastic * elastic / state.area;
    return response;
  }

  static double steepness(double /*widest*/, double /*reference*/) { return 1; }
};

}  // namespace floe
