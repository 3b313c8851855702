#include "mesh/cut_graph.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "floe/base/item.h"

namespace floe::mesh {
namespace {

constexpr double rounding = 1e-9;  ///< points nearer than this times the element size are one

struct Segment {
  Point2 from{}, direction{};
  double length = 0;

  Point2 at(double s) const { return {from[0] + s * direction[0], from[1] + s * direction[1]}; }
  /// Place along the segment and offset to its left of a point [m].
  Point2 local(const Point2& p) const {
    const double x = p[0] - from[0], y = p[1] - from[1];
    return {direction[0] * x + direction[1] * y, direction[0] * y - direction[1] * x};
  }
};

Segment segment(const Point2& from, const Point2& to) {
  const double x = to[0] - from[0], y = to[1] - from[1], length = std::hypot(x, y);
  return {from, length > 0 ? Point2{x / length, y / length} : Point2{1, 0}, length};
}

/// Puts coordinates that are those of a side to rounding onto the side.
Point2 snapped(Point2 p, const Point2& half, double tolerance) {
  for (int axis = 0; axis < 2; ++axis)
    if (std::abs(std::abs(p[axis]) - half[axis]) <= tolerance)
      p[axis] = std::copysign(half[axis], p[axis]);
  return p;
}

/// The part of a line inside the plan (Liang & Barsky 1984).
std::optional<Segment> clipped(const CutLine& line, const Point2& half, double tolerance) {
  const Segment whole = segment(line.from, line.to);
  double begin = 0, end = whole.length;
  for (int axis = 0; axis < 2; ++axis) {
    for (const double sign : {-1.0, 1.0}) {
      const double room = half[axis] - sign * whole.from[axis], rate = sign * whole.direction[axis];
      if (rate > 0) end = std::min(end, room / rate);
      if (rate < 0) begin = std::max(begin, room / rate);
      if (rate == 0 && room < 0) return std::nullopt;
    }
  }
  if (end - begin <= tolerance) return std::nullopt;
  const Segment inside =
      segment(snapped(begin > 0 ? whole.at(begin) : line.from, half, tolerance),
              snapped(end < whole.length ? whole.at(end) : line.to, half, tolerance));
  for (int axis = 0; axis < 2; ++axis) {  // along a side: there is nothing to cut
    if (std::abs(inside.from[axis]) == half[axis] &&
        inside.from[axis] == inside.at(inside.length)[axis])
      return std::nullopt;
  }
  return inside;
}

class Builder {
 public:
  Builder(const SheetPlan& plan, std::span<const CutLine> lines)
      : half_{plan.length / 2, plan.width / 2}, tolerance_(rounding * plan.element_size) {
    graph_.of_line.resize(lines.size());
    for (std::size_t k = 0; k < lines.size(); ++k) {
      const auto inside = clipped(lines[k], half_, tolerance_);
      if (!inside) continue;
      segments_.push_back(*inside);
      ends_.push_back({0, inside->length});
      line_.push_back(k);
    }
  }

  CutGraph build() {
    for (std::size_t i = 0; i < segments_.size(); ++i)
      for (std::size_t j = i + 1; j < segments_.size(); ++j) meet(i, j);
    for (std::size_t i = 0; i < segments_.size(); ++i) split(i);
    return std::move(graph_);
  }

 private:
  /// Notes where two segments meet.
  void meet(std::size_t i, std::size_t j) {
    const Segment &a = segments_[i], &b = segments_[j];
    for (const auto& [on, of, s] : {std::tuple{i, j, &a}, std::tuple{j, i, &b}}) {
      const Segment& other = segments_[of];
      for (const double end : {0.0, other.length}) {
        const auto [along, across] = s->local(other.at(end));
        if (std::abs(across) <= tolerance_) note(on, along);
      }
    }
    const double sine = a.direction[0] * b.direction[1] - a.direction[1] * b.direction[0];
    if (std::abs(sine) <= rounding) return;
    const auto [along, across] = a.local(b.from);
    const double on_b = -across / sine;
    const double cosine = a.direction[0] * b.direction[0] + a.direction[1] * b.direction[1];
    const double on_a = along + on_b * cosine;
    if (on_a < -tolerance_ || on_a > a.length + tolerance_ || on_b < -tolerance_ ||
        on_b > b.length + tolerance_)
      return;
    note(i, on_a);
    note(j, on_b);
  }

  void note(std::size_t i, double along) {
    if (along > -tolerance_ && along < segments_[i].length + tolerance_)
      ends_[i].push_back(std::clamp(along, 0.0, segments_[i].length));
  }

  void split(std::size_t i) {
    std::sort(ends_[i].begin(), ends_[i].end());
    std::int32_t last = -1;
    for (const double s : ends_[i]) {
      const std::int32_t node = node_at(segments_[i].at(s));
      if (node == last) continue;
      if (last >= 0) graph_.of_line[line_[i]].push_back(edge_between(last, node));
      last = node;
    }
  }

  std::int32_t node_at(const Point2& where) {
    const Point2 p = snapped(where, half_, tolerance_);
    const auto from = by_x_.lower_bound(p[0] - 4 * tolerance_);
    for (auto k = from; k != by_x_.end() && k->first <= p[0] + 4 * tolerance_; ++k) {
      const Point2& other = item(graph_.nodes, k->second).at;
      if (std::hypot(other[0] - p[0], other[1] - p[1]) <= 4 * tolerance_) return k->second;
    }
    const auto node = static_cast<std::int32_t>(graph_.nodes.size());
    const auto sides = static_cast<std::uint8_t>(
        (p[0] == -half_[0] ? side_left : 0) | (p[0] == half_[0] ? side_right : 0) |
        (p[1] == -half_[1] ? side_bottom : 0) | (p[1] == half_[1] ? side_top : 0));
    graph_.nodes.push_back({p, sides, {}});
    by_x_.emplace(p[0], node);
    return node;
  }

  std::int32_t edge_between(std::int32_t a, std::int32_t b) {
    const auto [at, is_new] = edges_.try_emplace({std::min(a, b), std::max(a, b)},
                                                 static_cast<std::int32_t>(graph_.edges.size()));
    if (!is_new) return at->second;
    const Segment s = segment(item(graph_.nodes, a).at, item(graph_.nodes, b).at);
    graph_.edges.push_back({{a, b}, s.direction, s.length});
    item(graph_.nodes, a).edges.push_back(at->second);
    item(graph_.nodes, b).edges.push_back(at->second);
    return at->second;
  }

  Point2 half_;
  double tolerance_;
  std::vector<Segment> segments_;
  std::vector<std::vector<double>> ends_;  ///< per segment: places where edges end
  std::vector<std::size_t> line_;          ///< per segment
  std::multimap<double, std::int32_t> by_x_;
  std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> edges_;
  CutGraph graph_;
};

}  // namespace

CutGraph make_cut_graph(const SheetPlan& plan, std::span<const CutLine> lines) {
  return Builder(plan, lines).build();
}

double distance(const CutGraph& graph, const CutEdge& edge, const Point2& p) {
  const Point2& from = item(graph.nodes, edge.nodes[0]).at;
  const double x = p[0] - from[0], y = p[1] - from[1];
  const double along = std::clamp(edge.direction[0] * x + edge.direction[1] * y, 0.0, edge.length);
  return std::hypot(x - along * edge.direction[0], y - along * edge.direction[1]);
}

}  // namespace floe::mesh
