/// \file
/// The lines of cuts as a graph: clipped to the plan, split where they meet.
#pragma once

#include <span>
#include <vector>

#include "floe/geometry/polyhedron.h"
#include "floe/mesh/cuts.h"

namespace floe::mesh {

/// An end of a line, or a place where lines meet.
struct CutNode {
  Point2 at{};
  std::uint8_t sides = 0;           ///< SheetSide bits of the sides on which it lies
  std::vector<std::int32_t> edges;  ///< that end here
};

/// A part of a line without another line's end on it.
struct CutEdge {
  std::array<std::int32_t, 2> nodes{};
  Point2 direction{};  ///< unit vector from the first node to the second
  double length = 0;   ///< [m]
};

struct CutGraph {
  std::vector<CutNode> nodes;
  std::vector<CutEdge> edges;
  std::vector<std::vector<std::int32_t>> of_line;  ///< per line: its edges
};

/// Parts of lines along the outline, and outside the plan, make no edges.
CutGraph make_cut_graph(const SheetPlan& plan, std::span<const CutLine> lines);

/// Distance of a point from an edge [m].
double distance(const CutGraph& graph, const CutEdge& edge, const Point2& p);

}  // namespace floe::mesh
