/// \file
/// A solid that is cut by planes into pieces.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "floe/geometry/half_space.h"
#include "solid/surface.h"

namespace floe {

/// A piece of a solid, bounded by a closed surface.
struct Piece {
  Surface surface;
  /// Of each triangle, the plane in which it lies: an index of a list of half-spaces that contain
  /// the piece near the triangle. Planes are those of the whole solid's triangles and of cuts, so
  /// that they do not lose digits as triangles get smaller.
  std::vector<std::int32_t> plane;
};

/// The pieces on both sides of a plane.
struct Halves {
  Piece below, above;  ///< inside the half-space of the plane, outside of it
};

/// Cuts a piece. Vertices within `rounding` of the plane count as in it. Both halves get the same
/// triangles in the plane, turned opposite ways.
/// \param planes    of the triangles; planes[cut] is the plane of the cut and planes[cut + 1] the
/// same plane, turned
/// \param rounding  [m]
/// \return nothing if the plane does not cut the piece, or if the boundary of the cut crosses
/// itself by rounding
std::optional<Halves> cut(const Piece& piece, const std::vector<HalfSpace>& planes,
                          std::int32_t cut, double rounding);

/// Divides a piece into its connected parts: triangles that share edges are connected.
std::vector<Piece> connected_parts(const Piece& piece);

/// Appends `other` to `piece`.
void append(Piece& piece, const Piece& other);

}  // namespace floe
