/// \file
/// Patches of the surface of an obstacle.
#pragma once

#include <span>
#include <vector>

#include "floe/contact/obstacle.h"
#include "floe/contact/surface_patch.h"

namespace floe {

/// Cuts the surface of an obstacle into patches: a grid of squares in each plane of its faces, with
/// lines along the steepest way up and across, one of them through z = 0 of the world, and the
/// origin of the obstacle's frame behind the middle of a square. Faces smaller than a square, and
/// rests at edges, are patches of their own.
/// \param size  of the squares [m]
/// \throws InputError if there would be more than a million
std::vector<SurfacePatch> surface_patches(const Obstacle& obstacle, double size);

/// Returns the area of a patch inside a convex body [m^2].
/// \param planes  of the body, in the frame of the obstacle
/// \param polygon, work  work space
double area_inside(const SurfacePatch& patch, std::span<const HalfSpace> planes,
                   SurfacePatch::Polygon& polygon, SurfacePatch::Polygon& work);

}  // namespace floe
