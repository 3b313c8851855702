/// \file
/// What the cuts of an overlap were, in bytes: enough to repeat their arithmetic without searching.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "geometry/edge_graph.h"

namespace floe {

/// Points by coordinates, each in a slot. The vertices of the overlap are in the lower half; those
/// of A before the first cut in the upper half.
struct Points {
  static constexpr std::size_t low = EdgeGraph::most_vertices, slots = 2 * low;
  alignas(64) std::array<double, slots> x{}, y{}, z{};
};

/// A vertex that a cut makes, at slot w, on the edge from u, inside, to v, outside.
struct NewPoint {
  std::uint8_t u, v, w;
};

/// The facets of an overlap, by slots.
struct Facets {
  struct Triangle {
    std::uint8_t p, q, r;
  };
  struct Edge {
    std::uint8_t a, b;
  };
  /// A closed surface of n vertices has at most 2 n - 4 triangles. The lists are filled up to whole
  /// registers with what has no area.
  static constexpr std::size_t padding = 8;
  static constexpr std::size_t most_triangles = 2 * Points::low + 2 * padding;
  static constexpr std::size_t most_edges = EdgeGraph::most_edges + padding;

  std::uint8_t slots = 0;                ///< all vertices are in slots below this one
  std::uint8_t apex = 0;                 ///< a vertex of the overlap
  std::uint8_t on_b = 0, triangles = 0;  ///< numbers: of triangles on B, which come first; of all
  std::uint8_t rim = 0;                  ///< number of edges
  std::array<Triangle, most_triangles> triangle;  ///< of faces on B, and of those without the apex
  std::array<Edge, most_edges> edge;  ///< between a facet on B, on their left, and one that is not
};

/// The cuts of one overlap. A cut depends on its points only by the mask of those inside, so the
/// record is right wherever the same planes leave the same masks.
struct CutRecord {
  struct Cut {
    std::uint32_t inside;  ///< mask of the vertices that stay; of the first cut: of those of A
    std::uint32_t left;    ///< mask of the vertices after the cut; 0: nothing is left
    std::uint8_t plane;    ///< its place in the order of planes
    std::uint8_t points;   ///< number of new points of this cut and those before it
  };
  static constexpr std::size_t most_cuts = 24, most_points = 96;

  std::uint8_t cuts = 0;                      ///< number; 0: there is no record
  std::uint8_t first = 0;                     ///< B's plane that cuts first
  std::uint8_t planes = 0, further_of_b = 0;  ///< numbers of planes: all, further ones of B
  std::array<Cut, most_cuts> cut;
  std::array<NewPoint, most_points> point;
  Facets facets;
};

}  // namespace floe
