/// \file
/// Stiffness of contacts: the constants of a pair, and the bound for the stable step.
#pragma once

#include "contact/pair.h"
#include "contact/solids.h"
#include "contact_laws/laws.h"

namespace floe {

/// Returns the constants of a pair.
/// \param wet  whether the contact is below still water
PairConstants pair_constants(const Solids& solids, const ContactOptions& options, const Pair& pair,
                             bool wet);

/// Bounds of M^-1 K and M^-1 C for all contacts that may form (estimate: model.md, "Contact").
struct ContactRates {
  double stiffness = 0;  ///< [1/s^2]
  double damping = 0;    ///< [1/s]
  double touch = 0;      ///< square of the angular frequency of a touch by a largest face [1/s^2]
  std::int32_t touching = -1;  ///< the body with this face
};
ContactRates contact_rates(const Solids& solids, const ContactOptions& options,
                           const ContactLaws& law);

}  // namespace floe
