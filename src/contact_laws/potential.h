/// \file
/// The contact law `potential` (Feng 2021; model.md, "Contact").
#pragma once

#include <algorithm>

#include "contact_laws/shared_terms.h"

namespace floe {

/// The gradient of the energy k_v (V - V_p)^2/(2 A_r): a pressure p = k_v (V - V_p)/A_r, whose
/// force is p S at c, with the couple p G_c. With its dashpot 2 zeta sqrt(m_eff k_v/A_r)|S| it is a
/// linear oscillator in the time integral of |S|, so that faces, edges and corners that meet
/// centrally return the same part of their speed, whatever it is.
struct PotentialLaw {
  static constexpr ContactLaw word = ContactLaw::potential;
  SharedConstants constants;

  explicit PotentialLaw(const ContactOptions& options) : constants(options) {}
  explicit constexpr PotentialLaw(const SharedConstants& shared) : constants(shared) {}

  template <class T>
  constexpr ElasticTermOf<T> term(const ContactStateOf<T>& state) const {
    const T stiffness = state.pair.stiffness, reference = state.pair.area;
    return {.rate = stiffness * state.area / reference,
            .couple = (stiffness / reference) * state.overlap.moment,
            .stiffness = stiffness / reference * state.area * state.area};
  }

  /// Returns the energy that the elastic force stores [J].
  static double stored(const ContactTrial& trial) {
    const double elastic = std::max(trial.volume - trial.memory.plastic, 0.0);
    return 0.5 * trial.pair.stiffness * elastic * elastic / trial.pair.area;
  }

  static double steepness(double widest, double reference) {
    return std::max(1.0, widest / reference);
  }
};

}  // namespace floe
