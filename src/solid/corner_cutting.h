/// \file
/// Polygons cut into triangles.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "solid/surface.h"

namespace floe {

/// Cuts a simple polygon in space, plane or nearly so, into triangles of its corners, in its
/// direction (Meisters' ears, 1975).
/// \param polygon  indices of `vertices`
std::vector<Surface::Triangle> cut_corners(std::span<const Point3> vertices,
                                           std::vector<std::int32_t> polygon);

}  // namespace floe
