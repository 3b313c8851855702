/// \file
/// Integrals over an overlap whose facets are known.
#pragma once

#include "geometry/cut_record.h"
#include "geometry/overlap.h"

namespace floe {

/// Returns the integrals over an overlap, zeros if its volume is not above 0.
/// \param with_patch  whether to integrate over the facets on B for Overlap::patch
Overlap facet_integrals(const Points& points, const Facets& facets, bool with_patch);

}  // namespace floe
