/// \file
/// Faces of the parts of obstacles as polygons.
#pragma once

#include <vector>

#include "floe/contact/obstacle.h"

namespace floe {

/// Returns the corners of the face in a plane of a part, counter-clockwise seen from outside; none
/// if it has no area.
/// \param near  distance within which a vertex counts as in the plane [m]
std::vector<Vec3<double>> face_in(const ConvexPart& part, const HalfSpace& plane, double near);
/// Returns the planes of a part without those that it has twice.
std::vector<HalfSpace> different_planes(const ConvexPart& part, double near);
/// Whether two planes are one, seen from the same side.
bool is_same(const HalfSpace& one, const HalfSpace& other, double near);

}  // namespace floe
