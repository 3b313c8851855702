/// \file
/// Planes between convex polyhedra: a cheap proof that two polyhedra do not touch.
#pragma once

#include <span>

#include "floe/base/rotation.h"
#include "geometry/vertex_lists.h"

namespace floe {

/// Returns the least n . r of vertices r [m, if n is a unit vector].
double lowest_along(const VertexLists& vertices, const Vec3<double>& n);

/// Width of the gap between the points of A and those of B along a unit vector that points from B
/// to A [m]; negative if their extents overlap.
double gap_along(std::span<const Vec3<double>> a, std::span<const Vec3<double>> b,
                 const Vec3<double>& axis);

/// Searches for an axis along which there is a gap (Chung & Wang 1996: the axis is mirrored on the
/// pair of vertices that contradicts it most).
/// \param a, b          points of A and of B [m]
/// \param[in,out] axis  unit vector from B to A: a guess, then the last axis of the search
/// \param tries         largest number of mirrorings
/// \returns the gap along the last axis [m], a lower bound of the distance. Not positive: no gap
/// was found, which does not prove an overlap
double separate(std::span<const Vec3<double>> a, std::span<const Vec3<double>> b,
                Vec3<double>& axis, int tries);

}  // namespace floe
