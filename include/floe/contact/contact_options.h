/// \file
/// The law of contacts and its numbers, as a scene states them (docs/model.md, "Contact").
#pragma once

#include <limits>

namespace floe {

enum class ContactLaw {
  overlap,    ///< F = k_v (V - V_p) at the overlap's centroid
  potential,  ///< the gradient of k_v (V - V_p)^2/(2 A_r) (Feng 2021)
};

/// What bodies that overlap at the start do.
enum class InitialOverlap {
  press,        ///< press apart; deep overlaps are refused
  stress_free,  ///< what overlaps at the start is taken as rest
};

struct ContactOptions {
  ContactLaw law = ContactLaw::overlap;
  double young = 1e8;                                              ///< E_c [Pa]
  double friction = 0.1;                                           ///< mu between bodies
  double damping_ratio = 0;                                        ///< zeta of the viscous term
  double plastic_limit = std::numeric_limits<double>::infinity();  ///< sigma_p [Pa]
  InitialOverlap initial_overlap = InitialOverlap::press;
};

}  // namespace floe
