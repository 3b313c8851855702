#include "geometry/edge_graph.h"

#include <algorithm>

#include "floe/base/item.h"

namespace floe {
namespace {

/// Adds the half-edges of the faces one by one.
class Builder {
 public:
  explicit Builder(std::size_t vertices) {
    graph_.vertices = static_cast<std::uint8_t>(vertices);
    for (Row& row : half_edge_) row.fill(none);
  }

  /// Returns the half-edge from a to b; nothing if there is one already, or no room.
  std::optional<std::uint8_t> add(std::uint8_t a, std::uint8_t b) {
    const std::uint8_t twin = half_edge_[b][a];
    if (a == b || half_edge_[a][b] != none) return std::nullopt;
    if (twin == none && graph_.edges == EdgeGraph::most_edges) return std::nullopt;
    const auto h = static_cast<std::uint8_t>(twin != none ? twin + 1 : 2 * graph_.edges++);
    half_edge_[a][b] = h;
    ++half_edges_;
    graph_.origin[h] = a;
    graph_.star[a] |= std::uint64_t{1} << (h / 2);
    return h;
  }
  void follow(std::uint8_t half_edge, std::uint8_t next) { graph_.next[half_edge] = next; }

  /// Returns the graph if all edges have both directions and all vertices have edges.
  std::optional<EdgeGraph> closed() const {
    const bool bare = std::any_of(graph_.star.begin(), graph_.star.begin() + graph_.vertices,
                                  [](std::uint64_t edges) { return edges == 0; });
    if (bare || half_edges_ != 2 * graph_.edges) return std::nullopt;
    return graph_;
  }

 private:
  static constexpr std::uint8_t none = 2 * EdgeGraph::most_edges;
  using Row = std::array<std::uint8_t, EdgeGraph::most_vertices>;

  EdgeGraph graph_;
  std::array<Row, EdgeGraph::most_vertices> half_edge_;  ///< from a to b
  int half_edges_ = 0;
};

/// Adds a face; returns false if a half-edge of it is there already, or there is no room.
bool add_face(Builder& builder, const Shapes& shapes, std::int32_t face, std::int32_t base) {
  const std::int32_t begin = item(shapes.corner_of, face), end = item(shapes.corner_of, face + 1);
  const auto corner = [&](std::int32_t c) {
    return static_cast<std::uint8_t>(item(shapes.corners, c) - base);
  };
  std::optional<std::uint8_t> first, last;
  for (std::int32_t c = begin; c < end; ++c) {
    const auto h = builder.add(corner(c), corner(c + 1 < end ? c + 1 : begin));
    if (!h) return false;
    if (last) builder.follow(*last, *h);
    if (!first) first = h;
    last = h;
  }
  if (last && first) builder.follow(*last, *first);
  return true;
}

}  // namespace

std::optional<EdgeGraph> edge_graph(const Shapes& shapes, std::int32_t body) {
  const std::int32_t base = item(shapes.vertex_of, body);
  const auto vertices = static_cast<std::size_t>(item(shapes.vertex_of, body + 1) - base);
  if (vertices > EdgeGraph::most_vertices) return std::nullopt;
  Builder builder(vertices);
  for (std::int32_t f = item(shapes.face_of, body); f < item(shapes.face_of, body + 1); ++f) {
    if (!add_face(builder, shapes, f, base)) return std::nullopt;
  }
  return builder.closed();
}

}  // namespace floe
