/// \file
/// Terms that contact laws share: crushing, the viscous term and friction (model.md, "Contact").
#pragma once

#include <algorithm>
#include <cmath>

#include "contact_laws/response.h"
#include "floe/contact_laws/contact_options.h"

namespace floe {

/// Constants of the terms that laws share.
struct SharedConstants {
  double damping_ratio = 0;  ///< zeta of the viscous term
  double plastic_limit = 0;  ///< sigma_p [Pa]

  explicit SharedConstants(const ContactOptions& options)
      : damping_ratio(options.damping_ratio), plastic_limit(options.plastic_limit) {}
};

/// The force along the normal.
struct NormalForce {
  double plastic = 0;   ///< V_p [m^3]
  double elastic = 0;   ///< [N]
  double pressing = 0;  ///< elastic and viscous, at least 0 and at most sigma_p |S| [N]
};

/// Returns the force along the normal of a contact with an elastic force proportional to V - V_p.
/// \param rate     elastic force per volume of overlap [N/m^3]
/// \param plastic  V_p before the evaluation [m^3]
inline NormalForce normal_force(const SharedConstants& constants, const ContactState& state,
                                double rate, double plastic) {
  const PairConstants& pair = state.pair;
  const double volume = state.overlap.volume;
  const double yield = constants.plastic_limit * state.area;
  if (rate * (volume - plastic) > yield) plastic = volume - yield / rate;
  const double elastic = rate * state.elastic_volume(plastic);
  const double approach = -dot(state.motion.velocity, state.normal);
  const double dashpot =
      2 * constants.damping_ratio * std::sqrt(pair.mass * pair.stiffness * state.area);
  const double pressing = std::min(std::max(elastic + dashpot * approach, 0.0), yield);
  return {.plastic = plastic, .elastic = elastic, .pressing = pressing};
}

/// Returns the response of a contact with an elastic force along the normal, without the energy
/// that this force stores and without a couple.
/// \param rate    elastic force per volume of overlap [N/m^3]
/// \param memory  history of the pair
inline ContactResponse elastic_response(const SharedConstants& constants, const ContactState& state,
                                        double rate, const PairHistory& memory) {
  const NormalForce normal = normal_force(constants, state, rate, memory.plastic);
  const double shear = 0.6 * state.pair.stiffness * state.area;  // k_t
  ContactResponse response;
  response.contact.normal = state.normal;
  response.contact.elastic = normal.elastic;
  response.contact.viscous = normal.pressing - normal.elastic;
  response.contact.memory = {
      .plastic = normal.plastic,
      .springs = cut(memory.springs, state.normal, shear, state.pair.friction * normal.pressing)};
  response.stored.tangential = response.contact.memory.springs.energy();
  return response;
}

}  // namespace floe
