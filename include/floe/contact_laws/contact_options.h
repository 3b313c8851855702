/// \file
/// The law of contacts and its constants, as a scene states them (model.md, "Contact").
#pragma once

#include <limits>

namespace floe {

/// Rule from an overlap to a wrench.
enum class ContactLaw {
  overlap,    ///< F = k_v (V - V_p) at the overlap's centroid
  potential,  ///< the gradient of k_v (V - V_p)^2/(2 A_r) (Feng 2021)
};

/// Treatment of bodies that overlap at the start.
enum class InitialOverlap {
  press,        ///< the bodies press each other apart; deep overlaps are refused
  stress_free,  ///< the overlap at the start is stress-free
};

/// Options of all contacts.
struct ContactOptions {
  ContactLaw law = ContactLaw::overlap;
  double young = 1e8;                                              ///< E_c [Pa]
  double friction = 0.1;                                           ///< mu between bodies
  double damping_ratio = 0;                                        ///< zeta of the viscous term
  double plastic_limit = std::numeric_limits<double>::infinity();  ///< sigma_p [Pa]
  InitialOverlap initial_overlap = InitialOverlap::press;
};

}  // namespace floe
