/// \file
/// Vertices by coordinates, for loops over lanes.
#pragma once

#include <cstddef>

namespace floe {

/// Lists of the coordinates of vertices [m]. Each is filled up to a multiple of `padding` with the
/// last vertex.
struct VertexLists {
  static constexpr std::size_t padding = 8;  ///< the widest register

  const double *x = nullptr, *y = nullptr, *z = nullptr;
  std::size_t number = 0;
};

}  // namespace floe
