/// \file
/// How far a convex hull lies from the solid that it is the hull of.
#pragma once

#include "solid/surface.h"

namespace floe {

/// Bounds of the largest distance of a point of the hull from the solid's surface [m].
struct HullDistance {
  double least = 0, most = 0;
};

/// Finds the largest distance of a point of the hull's surface from a solid's surface, by dividing
/// the hull's triangles where a bound is above what is wanted. A bound on a triangle is the largest
/// distance of its corners from one triangle of the solid, since the distance from a convex set is
/// convex.
/// \param hull        convex hull of `surface`
/// \param tolerance   > 0 [m]: the search ends once the distance is known to be above it, or known
/// to a tenth of it
HullDistance hull_distance(const Surface& hull, const Surface& surface, double tolerance);

}  // namespace floe
