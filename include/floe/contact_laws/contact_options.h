/// \file
/// The law of contacts and its constants, as a scene states them (model.md, "Contact").
#pragma once

#include <limits>
#include <optional>

#include "floe/geometry/periods.h"

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

/// What crushes ice: sigma_p = clamp(p0 (A/A0)^-m, least, most) (f + (1 - f) exp(-v/v_r)), with the
/// contact's area A and its speed of approach v >= 0. ISO 19906 has p0 = 7.4 MPa, m = 0.7 for A0 =
/// 1 m^2, at least 1.48 MPa; ice that is weaker when it crushes fast makes structures vibrate.
struct PlasticLimit {
  double pressure = std::numeric_limits<double>::infinity();  ///< p0 [Pa]
  double area = 1;                                            ///< A0 [m^2]
  double exponent = 0;                                        ///< m, below 1
  double least = 0;                                           ///< [Pa]
  double most = std::numeric_limits<double>::infinity();      ///< [Pa]
  double fast = 1;   ///< f, the part that is left at great speeds
  double speed = 1;  ///< v_r [m/s]

  /// Whether it limits anything.
  bool given() const { return pressure < std::numeric_limits<double>::infinity(); }
};

/// Options of all contacts.
struct ContactOptions {
  ContactLaw law = ContactLaw::overlap;
  double young = 1e8;                    ///< E_c [Pa]
  std::optional<double> young_broken{};  ///< E_c of pairs whose beam broke, if another [Pa]
  double friction = 0.1;                 ///< mu between bodies
  std::optional<double> friction_wet{};  ///< mu between bodies below still water, if another
  double damping_ratio = 0;              ///< zeta of the viscous term
  PlasticLimit plastic_limit{};          ///< sigma_p
  bool wear = true;                      ///< bodies lose what a contact crushes when it parts
  InitialOverlap initial_overlap = InitialOverlap::press;
  Periods periods{};          ///< of the model
  double inertia_factor = 1;  ///< moments of inertia of bodies over those of their shapes
};

}  // namespace floe
