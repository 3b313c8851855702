/// \file
/// Planes by which a piece of a solid may be cut.
#pragma once

#include <cstdint>
#include <vector>

#include "floe/geometry/half_space.h"
#include "solid/piece.h"
#include "solid/surface.h"

namespace floe {

/// A plane and what a cut by it does.
struct CutPlane {
  HalfSpace plane;
  double hulls = 0;     ///< sum of the volumes of the hulls of both sides [m^3]
  double resolved = 0;  ///< length of reflex edges in the plane over that of all
};

/// Returns planes that cut a piece, the best first: of those with nearly the least sum of the
/// volumes of the hulls of both sides, the one that holds most reflex edges. Planes are those of
/// the faces at long and deep reflex edges, the planes that halve the angle there and, unless
/// `through_edges`, those across the axes through such edges and through the middle of the piece.
/// \param planes         of the piece's triangles
/// \param hull           convex hull of the piece
/// \param through_edges  whether each plane must hold a reflex edge
/// \param rounding       vertices this far from a plane count as in it [m]
std::vector<CutPlane> cut_planes(const Piece& piece, const std::vector<HalfSpace>& planes,
                                 const Surface& hull, bool through_edges, double rounding);

}  // namespace floe
