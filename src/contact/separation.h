/// \file
/// Planes between convex polyhedra: the cheap way to see that two do not touch.
#pragma once

#include <span>

#include "floe/base/rotation.h"

namespace floe {

/// Width of the gap between the points of A and those of B along a unit vector that points from B
/// to A [m]; negative if their extents overlap.
double gap_along(std::span<const Vec3<double>> a, std::span<const Vec3<double>> b,
                 const Vec3<double>& axis);

/// Looks for an axis along which there is a gap, from a guess (Chung & Wang 1996: the axis is
/// mirrored on the pair of vertices that contradicts it most). Returns the gap along the axis as it
/// is then, a lower bound of the distance [m]; not positive if none was found, which proves
/// nothing. \param tries  mirrorings at the most
double separate(std::span<const Vec3<double>> a, std::span<const Vec3<double>> b,
                Vec3<double>& axis, int tries);

}  // namespace floe
