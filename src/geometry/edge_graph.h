/// \file
/// The surface of a convex polyhedron as a graph of half-edges, in bytes and bit masks.
#pragma once

#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "floe/geometry/polyhedron.h"

namespace floe {

/// Half-edges 2e and 2e + 1 are the two directions of edge e. A half-edge belongs to the face on
/// its left, seen from outside, so each half-edge is in one face and its twin in another.
struct EdgeGraph {
  static constexpr std::size_t most_vertices = 32, most_edges = 64;

  std::uint8_t vertices = 0, edges = 0;
  std::array<std::uint8_t, 2 * most_edges> origin{};  ///< vertex where a half-edge begins
  std::array<std::uint8_t, 2 * most_edges> next{};    ///< next half-edge of the same face
  std::array<std::uint64_t, most_vertices> star{};    ///< per vertex a mask of its edges

  friend auto operator<=>(const EdgeGraph&, const EdgeGraph&) = default;
};

/// Returns the graph of a body. Nothing if it has more vertices or edges than a graph holds, a
/// vertex without a face, or faces that do not close.
std::optional<EdgeGraph> edge_graph(const Shapes& shapes, std::int32_t body);

}  // namespace floe
