#include "mesh/cut_generators.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <set>
#include <utility>

#include "floe/base/item.h"

namespace floe::mesh {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double row = std::numbers::sqrt3 / 2;  ///< height over l of a cell that is l wide
constexpr double shortest_edge = 0.4;            ///< over l; shorter ones are not fitted
constexpr double smallest_scale = 0.25;          ///< of the sizes along an edge
constexpr double shrink = 0.75;                  ///< of the sizes in a conflict

/// The generators about a node lie on its circle, on both sides of each edge at the same angle.
struct NodePlan {
  double angle = 0;   ///< [rad]
  double radius = 0;  ///< [m]
};

/// Edges that need a generator or a disc.
using Edges = std::vector<std::int32_t>;

class Placer {
 public:
  Placer(const CutGraph& graph, const SheetPlan& plan)
      : graph_(graph),
        l_(plan.element_size),
        seed_(plan.seed),
        half_{plan.length / 2, plan.width / 2},
        scale_(graph.edges.size(), 1),
        fitted_(graph.edges.size(), 1) {
    for (std::size_t e = 0; e < fitted_.size(); ++e)
      fitted_[e] = graph.edges[e].length >= shortest_edge * l_;
  }

  CutGenerators run() {
    constexpr int most = 40;  // a conflict shrinks an edge four times at most, then drops it
    for (int attempt = 0; attempt < most; ++attempt) {
      place();
      if (!resolve_conflicts()) return std::move(result_);
    }
    std::fill(fitted_.begin(), fitted_.end(), std::uint8_t{0});
    place();
    return std::move(result_);
  }

 private:
  void place() {
    result_ = {};
    result_.pairs.resize(graph_.edges.size());
    placed_owner_.clear(), disc_owner_.clear();
    broken_.clear(), tight_.clear();
    ends_.assign(graph_.edges.size(), {});
    node_.assign(graph_.nodes.size(), {});
    for (std::size_t k = 0; k < graph_.nodes.size(); ++k) plan_node(k);
    for (std::size_t k = 0; k < graph_.nodes.size(); ++k) place_node(k);
    for (std::size_t e = 0; e < graph_.edges.size(); ++e)
      if (fitted_[e]) place_edge(static_cast<std::int32_t>(e));
  }

  std::vector<std::int32_t> fitted_edges(const CutNode& node) const {
    std::vector<std::int32_t> edges;
    for (const std::int32_t e : node.edges)
      if (item(fitted_, e)) edges.push_back(e);
    return edges;
  }

  /// Unit vector from a node along an edge.
  Point2 ray(std::int32_t edge, std::size_t node) const {
    const CutEdge& e = item(graph_.edges, edge);
    if (static_cast<std::size_t>(e.nodes[0]) == node) return e.direction;
    return {-e.direction[0], -e.direction[1]};
  }

  /// Directions of the outline at a node on it.
  std::vector<Point2> walls(const CutNode& node) const {
    std::vector<Point2> all;
    const auto add = [&](int axis, double sign) {
      if (sign * node.at[axis] < half_[axis])
        all.push_back(axis == 0 ? Point2{sign, 0} : Point2{0, sign});
    };
    for (const double sign : {-1.0, 1.0}) {
      if (node.sides & (side_left | side_right)) add(1, sign);
      if (node.sides & (side_bottom | side_top)) add(0, sign);
    }
    return all;
  }

  /// Angles between neighbouring edges at a node, and the smallest between an edge and the outline.
  std::pair<std::vector<double>, double> angles(std::size_t k,
                                                const std::vector<std::int32_t>& edges) const {
    std::vector<double> at;
    double wall = pi;
    for (const std::int32_t e : edges) {
      const Point2 u = ray(e, k);
      at.push_back(std::atan2(u[1], u[0]));
      for (const Point2& w : walls(graph_.nodes[k]))
        wall = std::min(wall,
                        std::abs(std::atan2(u[0] * w[1] - u[1] * w[0], u[0] * w[0] + u[1] * w[1])));
    }
    std::sort(at.begin(), at.end());
    std::vector<double> gaps;
    for (std::size_t i = 0; i < at.size(); ++i)
      gaps.push_back(i + 1 < at.size() ? at[i + 1] - at[i] : at[0] + 2 * pi - at[i]);
    return {gaps, wall};
  }

  void plan_node(std::size_t k) {
    const std::vector<std::int32_t> edges = fitted_edges(graph_.nodes[k]);
    if (edges.empty()) return;
    const double angle = angle_at(k, edges);
    node_[k] = {angle, radius_at(k, edges, std::cos(angle))};
  }

  /// Chooses the angle at a node. In the sector between two edges there are either two generators,
  /// far enough from each other, or one on the bisector.
  double angle_at(std::size_t k, const Edges& edges) const {
    const auto [gaps, wall] = angles(k, edges);
    constexpr double apart = pi / 6, usual = pi / 3, widest = 75 * pi / 180;
    double angle = *std::min_element(gaps.begin(), gaps.end()) / 2;
    if (angle > widest) angle = usual;
    angle = std::min(angle, wall / 2);
    const auto good = [&gaps = gaps](double a) {
      return std::all_of(gaps.begin(), gaps.end(), [a](double gap) {
        return std::abs(gap - 2 * a) < 1e-9 || gap - 2 * a >= apart - 1e-9;
      });
    };
    for (double less = angle; less > pi / 36; less -= pi / 180)
      if (good(less)) return less;
    return angle;
  }

  /// Chooses the radius at a node so that its circle is in nobody's way. [m]
  double radius_at(std::size_t k, const Edges& edges, double cosine) {
    const CutNode& node = graph_.nodes[k];
    const bool single = edges.size() == 1 && node.sides == 0;
    double radius = single ? l_ / std::numbers::sqrt3 : std::min(0.6, 0.5 / cosine) * l_;
    for (const std::int32_t e : edges)
      radius = std::min(radius, 0.3 * item(graph_.edges, e).length / cosine);
    std::int32_t culprit = -1;
    for (std::size_t e = 0; e < graph_.edges.size(); ++e) {
      const auto& ends = graph_.edges[e].nodes;
      const bool ends_here =
          static_cast<std::size_t>(ends[0]) == k || static_cast<std::size_t>(ends[1]) == k;
      if (!fitted_[e] || ends_here) continue;
      const double least = 0.3 * distance(graph_, graph_.edges[e], node.at);
      if (least < radius) radius = least, culprit = static_cast<std::int32_t>(e);
    }
    for (int axis = 0; axis < 2; ++axis) {
      const double limits[] = {half_[axis] - node.at[axis], half_[axis] + node.at[axis]};
      for (const double room : limits)
        if (room > 0) radius = std::min(radius, 0.45 * room);
    }
    const double unscaled = radius;
    for (const std::int32_t e : edges) radius = std::min(radius, unscaled * item(scale_, e));
    if (radius < smallest_scale * 0.6 * l_) {
      Edges all = edges;
      if (culprit >= 0) all.push_back(culprit);
      tight_.push_back(std::move(all));
    }
    return radius;
  }

  std::int32_t add(const Point2& at, double reach, Edges owner) {
    result_.placed.push_back({at, reach});
    placed_owner_.push_back(std::move(owner));
    return static_cast<std::int32_t>(result_.placed.size()) - 1;
  }

  void place_node(std::size_t k) {
    const CutNode& node = graph_.nodes[k];
    const std::vector<std::int32_t> edges = fitted_edges(node);
    if (edges.empty()) return;
    const auto [angle, radius] = node_[k];
    const double c = radius * std::cos(angle), s = radius * std::sin(angle);
    const double reach = std::min(0.62 * l_, 1.1 * radius);
    const auto first = result_.placed.size();
    const auto at = [&](const Point2& p) {
      for (std::size_t other = first; other < result_.placed.size(); ++other) {
        const Point2& q = result_.placed[other].at;
        if (std::hypot(q[0] - p[0], q[1] - p[1]) > 1e-6 * radius) continue;
        return static_cast<std::int32_t>(other);
      }
      return add(p, reach, edges);
    };
    for (const std::int32_t e : edges) {
      const Point2 u = ray(e, k);
      const Point2 foot{node.at[0] + c * u[0], node.at[1] + c * u[1]};
      const std::int32_t left = at({foot[0] - s * u[1], foot[1] + s * u[0]});
      const std::int32_t right = at({foot[0] + s * u[1], foot[1] - s * u[0]});
      const bool forward = static_cast<std::size_t>(item(graph_.edges, e).nodes[0]) == k;
      item(ends_, e)[forward ? 0 : 1] = forward ? std::array{left, right} : std::array{right, left};
    }
    if (edges.size() == 1 && node.sides == 0) {
      const Point2 u = ray(edges.front(), k);
      // Straight ahead both of the next facets would be at 60 degrees to the line, where a crack
      // has it hardest; in a mesh by chance one is at 30 in the mean. The seed says to which side.
      std::mt19937_64 engine(seed_ + k);
      constexpr double aside = pi / 6;
      const double across = ((engine() >> 63U) != 0 ? 1 : -1) * radius * std::sin(aside);
      const double ahead = radius * std::cos(aside);
      (void)at(
          {node.at[0] - ahead * u[0] - across * u[1], node.at[1] - ahead * u[1] + across * u[0]});
    }
    result_.discs.push_back({node.at, radius});
    disc_owner_.push_back(edges);
  }

  /// Returns the offset of the generators of an edge from it at a place on it, such that whole rows
  /// of cells fit between it and the next edge or the outline. [m]
  /// \param is_pair  notes a pair that has too little room
  double offset(std::int32_t edge, const Point2& p, bool is_pair) {
    const CutEdge& e = item(graph_.edges, edge);
    const double height = row * l_;
    double least = 0.5 * height, most = 0;
    std::int32_t culprit = edge;
    const auto fit = [&](double room, double fewest, std::int32_t by) {
      if (room > 6 * height) return;
      const double rows = std::max(fewest, std::round(room / height));
      if (room / (2 * rows) < least) least = room / (2 * rows), culprit = by;
      most = std::max(most, room / (2 * rows));
    };
    for (std::size_t k = 0; k < graph_.edges.size(); ++k) {
      const CutEdge& other = graph_.edges[k];
      if (!fitted_[k] || static_cast<std::int32_t>(k) == edge || is_beside(e, other)) continue;
      fit(distance(graph_, other, p), 2, static_cast<std::int32_t>(k));
    }
    for (int axis = 0; axis < 2; ++axis) {
      for (const int sign : {-1, 1}) {
        if (std::abs(e.direction[axis]) > std::sin(pi / 3) && leads_to(e, axis, sign)) continue;
        fit(half_[axis] - sign * p[axis], 1, edge);
      }
    }
    // Where all gaps ask for rows that are a little higher, they are.
    const double usual = 0.5 * height;
    const double chosen = least < usual ? least : std::clamp(most, usual, 1.3 * usual);
    const double size = chosen * item(scale_, edge), smallest = smallest_scale * usual;
    if (size < smallest && is_pair) tight_.push_back({edge, culprit});
    return std::max(size, smallest);
  }

  /// Whether two edges meet at an angle of 60 degrees or more, so that they are not in each other's
  /// way.
  bool is_beside(const CutEdge& e, const CutEdge& other) const {
    for (int i = 0; i < 2; ++i)
      for (int j = 0; j < 2; ++j) {
        if (e.nodes[i] != other.nodes[j]) continue;
        const double sign = i == j ? 1 : -1;
        const double cosine =
            sign * (e.direction[0] * other.direction[0] + e.direction[1] * other.direction[1]);
        if (cosine <= 0.5 + 1e-9) return true;
      }
    return false;
  }

  /// Whether an edge ends on the side sign * axis.
  bool leads_to(const CutEdge& e, int axis, int sign) const {
    return std::any_of(e.nodes.begin(), e.nodes.end(), [&](std::int32_t node) {
      return item(graph_.nodes, node).at[axis] == sign * half_[axis];
    });
  }

  /// Returns the spacing along the edge of pairs at an offset: the cells have the mean area. [m]
  double spacing(std::int32_t edge, double d) const {
    return std::min(std::clamp(row * l_ * l_ / (2 * d), 0.7 * l_, 1.15 * l_) * item(scale_, edge),
                    4.8 * d);
  }

  /// Returns places along an edge from `begin` to `end` at equal steps of the integral of
  /// ds/spacing, without these two. [m]
  std::vector<double> places(std::int32_t edge, double begin, double end) {
    const int samples = 8 + static_cast<int>(16 * (end - begin) / l_);
    const double step = (end - begin) / samples;
    std::vector<double> integral{0};
    double last = 0;
    for (int k = 0; k <= samples; ++k) {
      const double d = offset(edge, point(edge, begin + k * step), false);
      const double density = 1 / spacing(edge, d);
      if (k > 0) integral.push_back(integral.back() + 0.5 * (last + density) * step);
      last = density;
    }
    const int n = std::max(1, static_cast<int>(std::lround(integral.back())));
    std::vector<double> found;
    for (int k = 1; k < n; ++k) {
      const double wish = integral.back() * k / n;
      const auto above = std::lower_bound(integral.begin(), integral.end(), wish);
      const auto j = static_cast<std::size_t>(above - integral.begin());
      const double part = (wish - integral[j - 1]) / (integral[j] - integral[j - 1]);
      found.push_back(begin + (static_cast<double>(j - 1) + part) * step);
    }
    return found;
  }

  Point2 point(std::int32_t edge, double s) const {
    const CutEdge& e = item(graph_.edges, edge);
    const Point2& origin = item(graph_.nodes, e.nodes[0]).at;
    return {origin[0] + s * e.direction[0], origin[1] + s * e.direction[1]};
  }

  void place_edge(std::int32_t edge) {
    const CutEdge& e = item(graph_.edges, edge);
    const Point2& u = e.direction;
    const auto [angle0, radius0] = item(node_, e.nodes[0]);
    const auto [angle1, radius1] = item(node_, e.nodes[1]);
    const double begin = radius0 * std::cos(angle0);
    const double end = e.length - radius1 * std::cos(angle1);
    std::vector<Point2> local{{begin, radius0 * std::sin(angle0)}};  // place, offset
    auto& pairs = item(result_.pairs, edge);
    pairs.push_back(item(ends_, edge)[0]);
    for (const double s : places(edge, begin, end)) {
      const Point2 foot = point(edge, s);
      const double d = offset(edge, foot, true);
      const double reach = std::min(0.62 * l_, 1.45 * d);
      local.push_back({s, d});
      const std::int32_t left = add({foot[0] - d * u[1], foot[1] + d * u[0]}, reach, {edge});
      const std::int32_t right = add({foot[0] + d * u[1], foot[1] - d * u[0]}, reach, {edge});
      pairs.push_back({left, right});
    }
    local.push_back({end, radius1 * std::sin(angle1)});
    pairs.push_back(item(ends_, edge)[1]);
    add_discs(edge, local);
  }

  /// Adds the discs about the ends of an edge's facets, on whose rims two pairs lie each.
  /// \param local  place and offset of each pair
  void add_discs(std::int32_t edge, const std::vector<Point2>& local) {
    double before = 0;
    bool in_order = true;
    for (std::size_t k = 0; k + 1 < local.size(); ++k) {
      const auto [s0, d0] = local[k];
      const auto [s1, d1] = local[k + 1];
      const double middle = (s0 + s1) / 2 + (d1 * d1 - d0 * d0) / (2 * (s1 - s0));
      in_order = in_order && middle > before;
      before = middle;
      result_.discs.push_back({point(edge, middle), std::hypot(middle - s0, d0)});
      disc_owner_.push_back({edge});
    }
    if (!in_order || !(before < item(graph_.edges, edge).length)) broken_.push_back({edge});
  }

  /// Makes the cells of edges smaller that are in each other's way, or drops edges. \return whether
  /// there were conflicts
  bool resolve_conflicts() {
    std::vector<std::int32_t> order(result_.placed.size());
    for (std::size_t k = 0; k < order.size(); ++k) order[k] = static_cast<std::int32_t>(k);
    const auto x = [&](std::int32_t k) { return item(result_.placed, k).at[0]; };
    std::sort(order.begin(), order.end(),
              [&](std::int32_t a, std::int32_t b) { return x(a) < x(b); });
    if (!tight_.empty()) {
      drop_last(tight_);
      return true;
    }
    std::vector<Edges> conflicts = broken_;
    for (std::size_t d = 0; d < result_.discs.size(); ++d) {
      const auto& [centre, radius] = result_.discs[d];
      auto k = std::lower_bound(order.begin(), order.end(), centre[0] - radius,
                                [&](std::int32_t g, double limit) { return x(g) < limit; });
      for (; k != order.end() && x(*k) <= centre[0] + radius; ++k) {
        const Point2& z = item(result_.placed, *k).at;
        if (std::hypot(z[0] - centre[0], z[1] - centre[1]) >= radius * (1 - 1e-9)) continue;
        Edges both = disc_owner_[d];
        const Edges& other = item(placed_owner_, *k);
        both.insert(both.end(), other.begin(), other.end());
        conflicts.push_back(std::move(both));
      }
    }
    for (std::size_t k = 0; k < result_.placed.size(); ++k) {
      const Point2& z = result_.placed[k].at;
      if (std::abs(z[0]) > half_[0] - 1e-3 * l_ || std::abs(z[1]) > half_[1] - 1e-3 * l_)
        conflicts.push_back(placed_owner_[k]);
    }
    shrink_or_drop(conflicts);
    return !conflicts.empty();
  }

  void shrink_or_drop(const std::vector<Edges>& conflicts) {
    std::set<std::int32_t> involved;
    for (const Edges& edges : conflicts) involved.insert(edges.begin(), edges.end());
    for (const std::int32_t e : involved) item(scale_, e) *= shrink;
    std::vector<Edges> hopeless;
    for (const Edges& edges : conflicts) {
      if (std::any_of(edges.begin(), edges.end(),
                      [&](std::int32_t e) { return item(scale_, e) < smallest_scale; }))
        hopeless.push_back(edges);
    }
    drop_last(hopeless);
  }

  /// Drops an edge of each conflict, and lets the others have their sizes again.
  void drop_last(const std::vector<Edges>& conflicts) {
    for (const Edges& edges : conflicts) {
      // One that another conflict has dropped may have been in the way of this one.
      if (std::all_of(edges.begin(), edges.end(), [&](std::int32_t e) { return item(fitted_, e); }))
        item(fitted_, *std::max_element(edges.begin(), edges.end())) = 0;
    }
    if (!conflicts.empty()) std::fill(scale_.begin(), scale_.end(), 1.0);
  }

  const CutGraph& graph_;
  double l_;
  std::uint64_t seed_;
  Point2 half_;
  std::vector<double> scale_;         ///< per edge: of the sizes along it
  std::vector<std::uint8_t> fitted_;  ///< per edge
  std::vector<NodePlan> node_;
  std::vector<std::array<std::array<std::int32_t, 2>, 2>> ends_;  ///< per edge: pairs at its ends
  std::vector<Edges> placed_owner_, disc_owner_;
  std::vector<Edges> tight_;   ///< edges between which only too small cells have room
  std::vector<Edges> broken_;  ///< edges whose facets are not in order
  CutGenerators result_;
};

}  // namespace

CutGenerators place_generators(const CutGraph& graph, const SheetPlan& plan) {
  return Placer(graph, plan).run();
}

}  // namespace floe::mesh
