/// \file
/// Overlaps by GraphClipper, from what tests have.
#pragma once

#include <algorithm>
#include <optional>
#include <span>
#include <vector>

#include "geometry/graph_clipper.h"

namespace floe::test {

/// A body as GraphClipper takes it.
struct GraphBody {
  std::optional<EdgeGraph> graph;
  std::vector<double> coordinates;
  VertexLists lists;

  GraphBody(const Shapes& shapes, std::int32_t body) : graph(edge_graph(shapes, body)) {
    const auto b = static_cast<std::size_t>(body);
    const auto first = static_cast<std::size_t>(shapes.vertex_of[b]);
    const std::size_t number = static_cast<std::size_t>(shapes.vertex_of[b + 1]) - first;
    const std::size_t length = VertexLists::padded(number);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (std::size_t k = 0; k < length; ++k)
        coordinates.push_back(shapes.vertices[first + std::min(k, number - 1)][axis]);
    }
    const double* x = coordinates.data();
    lists = {.x = x, .y = x + length, .z = x + 2 * length, .number = number};
  }
  GraphBody(const GraphBody&) = delete;
  GraphBody& operator=(const GraphBody&) = delete;

  /// Returns the overlap of the body, turned by q and moved by x, with the planes.
  std::optional<Overlap> overlap(GraphClipper& clipper, const Quat<double>& q,
                                 const Vec3<double>& x, std::span<const HalfSpace> planes,
                                 CutRecord& record, bool with_patch = true,
                                 const FurtherPlanes& further = {}) const {
    if (!graph) return std::nullopt;
    clipper.place(lists, triad(q), x);
    Overlap found;
    if (!clipper.overlap(*graph, planes, with_patch, further, record, found)) return std::nullopt;
    return found;
  }
};

/// Whether two overlaps have the same bits.
inline bool same_bits(const Overlap& a, const Overlap& b) {
  const Patch &p = a.patch, &q = b.patch;
  return a.volume == b.volume && a.centroid == b.centroid && a.area == b.area &&
         a.moment == b.moment && p.area == q.area && p.middle == q.middle && p.u == q.u &&
         p.v == q.v && p.uu == q.uu && p.vv == q.vv && p.uv == q.uv && p.reach == q.reach;
}

}  // namespace floe::test
