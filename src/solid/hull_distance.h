/// \file
/// How far a convex hull lies from the solid that it is the hull of.
#pragma once

#include "solid/surface.h"

namespace floe {

/// Returns the largest distance of a point of the hull's surface from a solid's surface that is
/// found [m]: triangles of the hull that are not on the surface are divided, those with the largest
/// bound first, until no bound is above the tolerance, a point is, or there are 20,000 of them. A
/// bound on a triangle is the largest distance of its corners from one triangle of the solid, since
/// the distance from a convex set is convex.
/// \param hull       convex hull of `surface`
/// \param tolerance  > 0 [m]
/// \param rounding   triangles this near to a plane are in it [m]
double hull_distance(const Surface& hull, const Surface& surface, double tolerance,
                     double rounding);

}  // namespace floe
