/// \file
/// Convex hulls of fewer vertices.
#pragma once

#include <span>

#include "floe/geometry/half_space.h"
#include "solid/surface.h"

namespace floe {

/// Returns the hull of some of a hull's vertices, from which no point of the hull is farther than
/// `tolerance`: contact takes time by faces. Vertices come by their distance, apart from each
/// other, those at one distance together, so that symmetric hulls stay symmetric; those in the
/// planes `kept` all stay, so that faces between parts do. \param tolerance  > 0 [m] \param
/// rounding   within which vertices are in a plane [m] \param[out] distance  largest one that is
/// found [m]
Surface coarse_hull(const Surface& hull, std::span<const HalfSpace> kept, double tolerance,
                    double rounding, double& distance);

}  // namespace floe
