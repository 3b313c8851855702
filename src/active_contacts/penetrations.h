/// \file
/// Depths of overlaps, and bodies that lie inside others.
#pragma once

#include <cstdint>
#include <vector>

#include "active_contacts/active_contacts.h"
#include "contact/pair_list.h"
#include "contact/places.h"
#include "contact/solids.h"

namespace floe {

/// Depth of the overlap of a pair.
struct Penetration {
  std::int32_t a = 0, b = 0;  ///< bodies; b < 0: obstacle -1 - b
  double depth = 0;           ///< common part of both extents along the normal of the contact [m]
  /// Depth over the smaller size: cube root of the volume of a body, width of an obstacle.
  double share = 0;
};

/// Returns the penetrations of counted pairs, of contacts that have a normal, in list order.
std::vector<Penetration> penetrations(const Solids& solids, const PairList& list,
                                      const Places& places, const ActiveContacts& contacts);

}  // namespace floe
