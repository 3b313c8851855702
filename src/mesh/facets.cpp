// The polygons, facets and sides of a finished Voronoi diagram.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/union_find.h"
#include "mesh/voronoi.h"

namespace floe::mesh {
namespace {

constexpr double shortest = 1e-9;  ///< facets below this times the element size are dropped

}  // namespace

/// Merges Voronoi vertices that are closer than the shortest facet, and moves vertices that close
/// to a side onto the side. All cells at a merged vertex share it, so the cells still tile the plan
/// without gap or overlap, and no polygon has an edge without a facet.
void Voronoi::merge_close_vertices() {
  const double tolerance = shortest * l_;
  const std::int32_t triangles = delaunay_.triangles();
  for (std::int32_t t = 0; t < triangles; ++t) {
    for (const auto& [axis, limit] : {std::pair{0, x1_}, std::pair{1, y1_}}) {
      double& x = centre_[t][axis];
      if (std::abs(std::abs(x) - limit) < tolerance) x = std::copysign(limit, x);
    }
    out_[t] = outcode(centre_[t]);
  }
  UnionFind places(static_cast<std::size_t>(triangles));
  for (std::int32_t e = 0; e < 3 * triangles; ++e) {
    const std::int32_t s = e / 3, t = delaunay_.twin(e) / 3;
    if (e > delaunay_.twin(e) || out_[s] || out_[t]) continue;
    if (std::hypot(centre_[s][0] - centre_[t][0], centre_[s][1] - centre_[t][1]) >= tolerance)
      continue;
    places.unite(s, t);
  }
  for (std::int32_t t = 0; t < triangles; ++t) centre_[t] = centre_[places.find(t)];
}

/// Returns the length inside the plan of the edge from p to q [m]; negative if the edge lies
/// outside (Liang & Barsky 1984).
double Voronoi::clipped_width(const Point2& p, const Point2& q) const {
  const double dx = q[0] - p[0], dy = q[1] - p[1];
  double from = 0, to = 1;
  for (const auto& [start, step, limit] : {std::array{p[0], dx, x1_}, std::array{p[1], dy, y1_}}) {
    for (const double sign : {-1.0, 1.0}) {
      const double room = limit - sign * start, rate = sign * step;
      if (rate > 0) to = std::min(to, room / rate);
      if (rate < 0) from = std::max(from, room / rate);
      if (rate == 0 && room < 0) return -1;
    }
  }
  return (to - from) * std::hypot(dx, dy);
}

Tessellation Voronoi::finish(std::span<const std::int32_t> number) {
  // Built anew, so that the result depends on the positions of the generators only, not on their
  // earlier motion.
  frame();
  update_cells();
  const auto n = static_cast<std::int32_t>(generators_.size());
  circumcentres(0, n);
  merge_close_vertices();

  std::vector<std::int32_t> from(n);  // the generator of each cell
  for (std::int32_t k = 0; k < n; ++k) from[number[k]] = k;
  Tessellation result;
  result.generators.reserve(n);
  result.vertices.reserve(6 * generators_.size());
  result.facets.reserve(3 * generators_.size());
  result.offset.assign(1, 0);
  result.offset.reserve(n + 1);
  result.sides.assign(n, 0);
  double energy = 0, move = 0;
  std::vector<Facet> of_cell;
  const double tolerance = shortest * l_, rounding = 1e-13 * (x1_ + y1_);
  for (std::int32_t k = 0; k < n; ++k) {
    const std::int32_t generator = from[k], begin = delaunay_.outgoing(generator);
    std::uint8_t out = 0;
    polygon_.clear();
    of_cell.clear();
    std::int32_t e = begin;
    do {
      const Point2& p = centre_[e / 3];
      out |= out_[e / 3];
      if (polygon_.empty() || polygon_.back() != p) polygon_.push_back(p);
      const std::int32_t neighbour = delaunay_.origin(Delaunay::next(e));
      if (neighbour < n && number[neighbour] > k) {
        const double width = clipped_width(centre_[delaunay_.twin(e) / 3], p);
        if (width >= tolerance)
          of_cell.push_back({{k, number[neighbour]}, width});
        else if (width >= 0)
          ++result.degenerate;
      }
      e = delaunay_.turn(e);
    } while (e != begin);
    if (out) clip();
    const auto same = [rounding](const Point2& p, const Point2& q) {
      return std::abs(p[0] - q[0]) + std::abs(p[1] - q[1]) <= rounding;
    };
    polygon_.erase(std::unique(polygon_.begin(), polygon_.end(), same), polygon_.end());
    while (polygon_.size() > 1 && same(polygon_.front(), polygon_.back())) polygon_.pop_back();

    Point2 p = polygon_.back();
    for (const Point2& q : polygon_) {
      const auto on = [&](int axis, double limit) {
        return p[axis] == limit && q[axis] == limit &&
               std::abs(p[1 - axis] - q[1 - axis]) >= tolerance;
      };
      result.sides[k] |=
          static_cast<std::uint8_t>((on(0, -x1_) ? side_left : 0) | (on(0, x1_) ? side_right : 0) |
                                    (on(1, -y1_) ? side_bottom : 0) | (on(1, y1_) ? side_top : 0));
      p = q;
    }
    std::sort(of_cell.begin(), of_cell.end(),
              [](const Facet& a, const Facet& b) { return a.cells < b.cells; });
    result.facets.insert(result.facets.end(), of_cell.begin(), of_cell.end());
    result.vertices.insert(result.vertices.end(), polygon_.begin(), polygon_.end());
    result.offset.push_back(static_cast<std::int32_t>(result.vertices.size()));
    const Point2& z = generators_[generator];
    const Cell& cell = cells_[generator];
    result.generators.push_back(z);
    energy += cell.energy;
    move = std::max(move, std::hypot(cell.centroid[0] - z[0], cell.centroid[1] - z[1]));
  }
  const double area = 4 * x1_ * y1_;
  const double hexagons = 5 / (18 * std::numbers::sqrt3) * area * area / n;
  result.energy_ratio = energy / hexagons;
  result.largest_move = move / l_;
  return result;
}

}  // namespace floe::mesh
