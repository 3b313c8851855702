/// \file
/// Generators whose cells have facets on the lines of cuts.
///
/// A facet lies on a line where the two generators nearest to the line are images of each other in
/// it. Such pairs are placed along every edge of the graph. Consecutive pairs lie on a circle about
/// the place on the line where their facets meet (as in Merland et al. 2014 for faults, Abdelkader
/// et al. 2020, "VoroCrust", for surfaces). Inside these circles there is no other generator, so
/// every point of the edge has the two of a pair nearest: the facets cover the edge from end to
/// end. At its nodes the generators of all edges lie on one circle; where an edge ends inside the
/// plan a single generator on its prolongation closes it.
#pragma once

#include <array>
#include <vector>

#include "mesh/cut_graph.h"

namespace floe::mesh {

struct CutGenerators {
  struct Placed {
    Point2 at{};
    double reach = 0;  ///< no generator but a placed one comes nearer [m]
  };
  struct Disc {
    Point2 centre{};
    double radius = 0;  ///< no generator lies inside [m]
  };
  std::vector<Placed> placed;
  std::vector<Disc> discs;
  /// Per edge of the graph: the pairs along it, indices of `placed`; none if the edge would need
  /// cells that are too small.
  std::vector<std::vector<std::array<std::int32_t, 2>>> pairs;
};

CutGenerators place_generators(const CutGraph& graph, const SheetPlan& plan);

}  // namespace floe::mesh
