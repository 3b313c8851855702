/// \file
/// Vertices by coordinates, for loops over lanes.
#pragma once

#include <cstddef>

namespace floe {

/// Lists of the coordinates of vertices [m]. Each is filled up to a multiple of `padding` with the
/// last vertex.
struct VertexLists {
  static constexpr std::size_t padding = 4;  ///< lanes of a short loop (FewLanes) at most

  /// Returns the length of lists of n vertices.
  static constexpr std::size_t padded(std::size_t n) {
    return (n + padding - 1) / padding * padding;
  }

  const double *x = nullptr, *y = nullptr, *z = nullptr;
  std::size_t number = 0;
};

}  // namespace floe
