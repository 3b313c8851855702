/// \file
/// Vertices by coordinates, for loops over lanes.
#pragma once

#include <cstddef>

namespace floe {

/// Lists of the coordinates of vertices [m]. Each is filled up to a multiple of `padding` with the
/// last vertex.
struct VertexLists {
  static constexpr std::size_t padding = 4;  ///< lanes of a short loop (FewLanes) at most

  const double *x = nullptr, *y = nullptr, *z = nullptr;
  std::size_t number = 0;
};

}  // namespace floe
