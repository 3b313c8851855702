/// \file
/// Polyhedra of plane polygons from convex hulls of triangles.
#pragma once

#include "floe/geometry/polyhedron.h"
#include "solid/surface.h"

namespace floe {

/// Appends a convex hull as one body. Triangles within `rounding` of one plane become one face;
/// vertices inside a face, and those on a straight edge, are left out.
/// \param rounding  [m]
void append_hull(Shapes& shapes, const Surface& hull, double rounding);

}  // namespace floe
