/// \file
/// What the cuts of an overlap were, in bytes: enough to repeat their arithmetic without searching.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "geometry/edge_graph.h"

namespace floe {

/// Points by coordinates, each in a slot. The vertices of the overlap are in the lower half; those
/// of A before the first cut in the upper half.
struct Points {
  static constexpr std::size_t low = EdgeGraph::most_vertices, slots = 2 * low;
  alignas(64) std::array<double, slots> x{}, y{}, z{};
};

/// Three slots: of a new vertex c, on the edge from a, inside, to b, outside; of a triangle; or of
/// an edge from a to b.
struct Triple {
  std::uint8_t a, b, c;
};

/// The facets of an overlap. The lists are filled up to whole registers with what has no area.
struct Facets {
  std::size_t slots = 0;              ///< all vertices are in slots below this one
  std::size_t apex = 0;               ///< slot of a vertex of the overlap
  std::size_t on_b = 0;               ///< number of the triangles that are on B
  std::span<const Triple> triangles;  ///< of faces on B, then of other faces without the apex
  std::span<const Triple> rim;  ///< edges between a facet on B, on their left, and one that is not
};

/// The cuts of one overlap, and the facets that they leave. A cut depends on its points only by the
/// mask of those inside, so the record is right wherever the same planes leave the same masks. What
/// is read is in few lines of the cache.
struct alignas(64) CutRecord {
  struct Cut {
    std::uint32_t inside;  ///< mask of the vertices that stay; of the first cut: of those of A
    std::uint8_t plane;    ///< its place in the order of planes
    std::uint8_t points;   ///< number of new vertices of this cut and those before it
  };
  /// A closed surface of n vertices has at most 2 n - 4 triangles.
  static constexpr std::size_t padding = 4;  ///< lanes of a register
  static constexpr std::size_t most_cuts = 23, most_points = 96;
  static constexpr std::size_t most_triangles = 2 * Points::low + 2 * padding;
  static constexpr std::size_t most_edges = EdgeGraph::most_edges + padding;

  std::uint8_t cuts = 0;                            ///< number; 0: there is no record of cuts
  std::uint8_t first = 0;                           ///< B's plane that cuts first
  std::uint8_t planes = 0, further_of_b = 0;        ///< numbers of planes: all, further ones of B
  std::uint8_t points = 0, triangles = 0, rim = 0;  ///< numbers of triples
  std::uint8_t slots = 0, apex = 0, on_b = 0;       ///< of Facets
  std::array<Cut, most_cuts> cut;
  /// New vertices, then triangles, then edges of the rim.
  std::array<Triple, most_points + most_triangles + most_edges> triple;

  Facets facets() const {
    const auto list = [&](std::size_t begin, std::size_t number) {
      return std::span(triple).subspan(begin, number);
    };
    const std::size_t end = std::size_t{points} + triangles;
    return {.slots = slots,
            .apex = apex,
            .on_b = on_b,
            .triangles = list(points, triangles),
            .rim = list(end, rim)};
  }
};

}  // namespace floe
