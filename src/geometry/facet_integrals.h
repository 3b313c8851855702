/// \file
/// Integrals over an overlap whose facets are known.
#pragma once

#include "geometry/cut_record.h"
#include "geometry/overlap.h"

namespace floe {

/// Sets the integrals over an overlap, unless its volume is not above 0.
/// \param overlap     zeros
/// \param with_patch  whether to integrate over the facets on B for Overlap::patch
void set_integrals(Overlap& overlap, const Points& points, const Facets& facets, bool with_patch);

}  // namespace floe
