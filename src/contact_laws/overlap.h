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
  explicit constexpr OverlapLaw(const SharedConstants& shared) : constants(shared) {}

  template <class T>
  constexpr ElasticTermOf<T> term(const ContactStateOf<T>& state) const {
    return {
        .rate = state.pair.stiffness, .couple = {}, .stiffness = state.pair.stiffness * state.area};
  }

  /// Returns the energy that the elastic force stores [J].
  static double stored(const ContactTrial& trial) {
    const double k = trial.pair.stiffness, plastic = trial.memory.plastic;
    if (trial.pair.half_space != 0)
      return k * stored_volume(trial.volume, trial.area, trial.depth, plastic);
    const double elastic = std::max(trial.volume - plastic, 0.0);
    return 0.5 * k * elastic * elastic / trial.area;
  }

  /// Returns the integral of V - V_p over the depth, from where V was V_p on [m^4]. Without V_p it
  /// is V times the depth of the centroid. Faces, edges and corners have V = (1/p)|S| x for the
  /// deepest point's depth x, p = 1, 2, 3, and the centroid at x/(p + 1); with p of the shape at
  /// hand the integral is exact for them, and its V_p -> 0 is exact for all.
  static double stored_volume(double volume, double area, double depth, double plastic) {
    if (plastic == 0) return volume * depth;
    const double part = plastic / volume;
    if (part >= 1) return 0;
    const double inverse = 1 / depth - area / volume;  // 1/x
    if (!(inverse > 0)) return volume * depth * (1 - part) * (1 - part);
    const double deepest = 1 / inverse, power = deepest * area / volume;
    const double left = std::pow(part, 1 / power);  // x where V was V_p, over x
    return volume * (depth * (1 - part * left) - part * deepest * (1 - left));
  }

  static double steepness(double /*widest*/, double /*reference*/) { return 1; }
};

}  // namespace floe
