#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "floe/base/item.h"
#include "mesh/cut_generators.h"
#include "mesh/voronoi.h"

namespace floe {
namespace mesh {
namespace {

/// Points with a radius each, to ask which of them a point is near to.
class Surroundings {
 public:
  void add(const Point2& centre, double radius) {
    circles_.push_back({centre, radius});
    largest_ = std::max(largest_, radius);
    sorted_ = false;
  }

  /// Whether a point lies inside one of the circles, each times `factor`.
  bool contain(const Point2& p, double factor = 1) const {
    const double reach = factor * largest_;
    auto k = std::lower_bound(circles_.begin(), circles_.end(), p[0] - reach,
                              [](const Circle& c, double x) { return c.centre[0] < x; });
    for (; k != circles_.end() && k->centre[0] <= p[0] + reach; ++k)
      if (std::hypot(k->centre[0] - p[0], k->centre[1] - p[1]) < factor * k->radius) return true;
    return false;
  }

  void sort() {
    if (!std::exchange(sorted_, true))
      std::sort(circles_.begin(), circles_.end(),
                [](const Circle& a, const Circle& b) { return a.centre < b.centre; });
  }

 private:
  struct Circle {
    Point2 centre;
    double radius;
  };
  std::vector<Circle> circles_;
  double largest_ = 0;
  bool sorted_ = true;
};

constexpr double clear = 1.05;  ///< free generators stay this times a disc's radius away
constexpr double hole = 0.78;   ///< over l: an empty circle of this radius gets a generator
constexpr double affected = 3;  ///< over l: nearer free generators relax again
constexpr int sweeps = 60;      ///< of that relaxation

/// The generators of a plan with lines.
struct Fit {
  const SheetPlan& plan;
  CutGenerators cuts;
  Surroundings discs, reaches, band;
  std::vector<Point2> generators;    ///< those that were placed first
  std::vector<std::int32_t> number;  ///< of each one in the mesh

  Fit(const SheetPlan& p, const CutGraph& graph) : plan(p), cuts(place_generators(graph, p)) {
    const double l = plan.element_size;
    for (const auto& [centre, radius] : cuts.discs) discs.add(centre, radius);
    for (const auto& [at, reach] : cuts.placed) {
      reaches.add(at, reach);
      band.add(at, affected * l);
      generators.push_back(at);
    }
    discs.sort(), reaches.sort(), band.sort();
  }

  bool is_free(std::size_t k) const { return k >= cuts.placed.size(); }
  bool may_be_at(const Point2& p) const { return !discs.contain(p, clear); }

  /// Takes the generators that are in the way of no placed one.
  void take(std::span<const Point2> old) {
    for (const Point2& z : old)
      if (may_be_at(z) && !reaches.contain(z)) generators.push_back(z);
  }

  /// Puts generators into holes that are left near the lines, the largest first: a hole is an empty
  /// circle about a Voronoi vertex.
  void fill() {
    const double l = plan.element_size;
    constexpr int most = 20;
    for (int round = 0; round < most; ++round) {
      const Tessellation t = tessellate(plan, generators);
      std::vector<std::pair<double, Point2>> holes;
      for (std::size_t k = 0; k < generators.size(); ++k) {
        const Point2& z = generators[k];
        if (!band.contain(z)) continue;
        for (std::int32_t v = t.offset[k]; v < t.offset[k + 1]; ++v) {
          const Point2& p = item(t.vertices, v);
          const double radius = std::hypot(p[0] - z[0], p[1] - z[1]);
          const double room =
              std::min(plan.length / 2 - std::abs(p[0]), plan.width / 2 - std::abs(p[1]));
          if (radius > hole * l && room > 0.25 * l && may_be_at(p)) holes.emplace_back(radius, p);
        }
      }
      if (holes.empty()) return;
      std::sort(holes.begin(), holes.end(), std::greater<>());
      const std::size_t before = generators.size();
      for (const auto& [radius, p] : holes) {
        const bool is_apart = std::all_of(
            generators.begin() + static_cast<std::ptrdiff_t>(before), generators.end(),
            [&](const Point2& z) { return std::hypot(z[0] - p[0], z[1] - p[1]) > hole * l; });
        if (is_apart) generators.push_back(p);
      }
    }
  }

  /// Moves the free generators near the lines to the centroids of their cells, sweep by sweep.
  Tessellation relax(const Share& share) {
    const std::vector<std::int32_t> order = hilbert_order(generators, plan.length, plan.width);
    number.resize(order.size());
    std::vector<Point2> at(order.size());
    std::vector<std::uint8_t> moves(order.size());
    for (std::size_t k = 0; k < order.size(); ++k) {
      const auto from = static_cast<std::size_t>(order[k]);
      item(number, order[k]) = static_cast<std::int32_t>(k);
      at[k] = generators[from];
      moves[k] = is_free(from) && band.contain(at[k]);
    }
    Voronoi voronoi(plan, at, share);
    for (int sweep = 0; sweep < sweeps; ++sweep) {
      for (std::size_t k = 0; k < at.size(); ++k)
        if (moves[k] && may_be_at(voronoi.cells()[k].centroid)) at[k] = voronoi.cells()[k].centroid;
      voronoi.move(at);
    }
    std::vector<std::int32_t> same(at.size());
    std::iota(same.begin(), same.end(), 0);
    return voronoi.finish(same);
  }
};

}  // namespace
}  // namespace mesh

FittedCells fit_to_cuts(const SheetPlan& plan, Tessellation cells, std::span<const CutLine> lines,
                        MPI_Comm comm) {
  const mesh::CutGraph graph = mesh::make_cut_graph(plan, lines);
  mesh::Fit fit(plan, graph);
  FittedCells result;
  if (fit.cuts.placed.empty()) {  // the cells stay
    result.cells = std::move(cells);
    for (const auto& edges : graph.of_line) {
      result.cuts.emplace_back();
      for (const std::int32_t e : edges) result.cuts.back().length += item(graph.edges, e).length;
    }
    return result;
  }
  fit.take(cells.generators);
  fit.fill();
  result.cells = fit.relax(mesh::Share(comm));
  const auto& facets = result.cells.facets;
  for (const auto& edges : graph.of_line) {
    FittedCut cut;
    for (const std::int32_t e : edges) {
      cut.length += item(graph.edges, e).length;
      for (const auto& [left, right] : item(fit.cuts.pairs, e)) {
        std::array<std::int32_t, 2> pair{item(fit.number, left), item(fit.number, right)};
        if (pair[0] > pair[1]) std::swap(pair[0], pair[1]);
        const auto facet =
            std::lower_bound(facets.begin(), facets.end(), pair,
                             [](const Facet& f, const auto& p) { return f.cells < p; });
        if (facet == facets.end() || facet->cells != pair) continue;
        cut.followed += facet->width;
        cut.pairs.push_back(pair);
      }
    }
    result.cuts.push_back(std::move(cut));
  }
  return result;
}

}  // namespace floe
