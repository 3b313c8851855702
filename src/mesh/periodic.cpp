#include "mesh/periodic.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "mesh/voronoi.h"

namespace floe::mesh {
namespace {

/// Generators, and behind them images of those near the bottom and top sides of a periodic plan,
/// beyond the other side.
struct Repeated {
  SheetPlan plan;  ///< the rectangle in which all of them lie
  std::vector<Point2> points;
  std::vector<std::int32_t> original;  ///< of each image
  std::vector<double> shift;           ///< along y, of each image from its original [m]
};

/// \param depth  from the sides, within which generators have images [m]; 0: there are none
Repeated repeated(const SheetPlan& plan, std::span<const Point2> points, double depth) {
  Repeated all{.plan = plan, .points{points.begin(), points.end()}, .original = {}, .shift = {}};
  all.plan.periodic = false;
  all.plan.width = plan.width + 2 * depth;
  for (const double side : {-0.5, 0.5}) {
    const double shift = -2 * side * plan.width;  // beyond the other side
    for (std::size_t k = 0; k < points.size(); ++k) {
      const double y = points[k][1] + shift;
      if (std::abs(y) > all.plan.width / 2) continue;
      all.points.push_back({points[k][0], y});
      all.original.push_back(static_cast<std::int32_t>(k));
      all.shift.push_back(shift);
    }
  }
  return all;
}

/// Depth of images with which sweeps begin [m].
double usual_depth(const SheetPlan& plan) { return std::min(6 * plan.element_size, plan.width); }

/// Whether the polygons of the first n cells are those among all images, though there are only some
/// of these: no generator beyond the limits of y is nearer to a vertex than the cell's own.
bool covers(const Tessellation& cells, std::size_t n, double limit) {
  for (std::size_t k = 0; k < n; ++k) {
    for (std::int32_t v = cells.offset[k]; v < cells.offset[k + 1]; ++v) {
      const Point2 &p = cells.vertices[v], &z = cells.generators[k];
      if (std::abs(p[1]) + std::hypot(p[0] - z[0], p[1] - z[1]) > limit) return false;
    }
  }
  return true;
}

/// The cells of the originals, with each facet across the seam once. Nothing if a cell would have
/// two facets with another.
std::optional<Tessellation> cells_of_originals(const Tessellation& cells, const Repeated& all,
                                               std::size_t n) {
  Tessellation own;
  own.generators.assign(cells.generators.begin(),
                        cells.generators.begin() + static_cast<std::ptrdiff_t>(n));
  own.offset.assign(cells.offset.begin(),
                    cells.offset.begin() + static_cast<std::ptrdiff_t>(n) + 1);
  own.vertices.assign(cells.vertices.begin(), cells.vertices.begin() + own.offset.back());
  own.sides.assign(cells.sides.begin(), cells.sides.begin() + static_cast<std::ptrdiff_t>(n));
  const auto count = static_cast<std::int32_t>(n);
  for (const Facet& facet : cells.facets) {
    const auto [i, j] = facet.cells;
    if (i >= count) continue;
    if (j < count) {
      own.facets.push_back(facet);
      continue;
    }
    const auto image = static_cast<std::size_t>(j - count);
    const std::int32_t original = all.original[image];
    if (all.shift[image] < 0) continue;  // the same facet from its other side
    if (original == i) return {};
    if (i < original)
      own.facets.push_back({{i, original}, facet.width, all.shift[image]});
    else
      own.facets.push_back({{original, i}, facet.width, -all.shift[image]});
  }
  const auto by_cells = [](const Facet& a, const Facet& b) { return a.cells < b.cells; };
  std::sort(own.facets.begin(), own.facets.end(), by_cells);
  const auto twice = [](const Facet& a, const Facet& b) { return a.cells == b.cells; };
  if (std::adjacent_find(own.facets.begin(), own.facets.end(), twice) != own.facets.end())
    return {};
  own.degenerate = cells.degenerate;
  return own;
}

}  // namespace

void relax_some(const SheetPlan& plan, std::vector<Point2>& points,
                std::span<const std::size_t> moving, MPI_Comm comm) {
  const std::size_t n = points.size();
  Repeated all = repeated(plan, points, plan.periodic ? usual_depth(plan) : 0);
  Voronoi voronoi(all.plan, all.points, Share(comm));
  for (int sweep = 0; sweep < plan.iterations; ++sweep) {
    for (const std::size_t p : moving) all.points[p] = voronoi.cells()[p].centroid;
    for (std::size_t k = n; k < all.points.size(); ++k) {
      const Point2& z = all.points[static_cast<std::size_t>(all.original[k - n])];
      // An image that left the rectangle would have no cell; so near its edge it does not matter.
      const double most = all.plan.width / 2;
      all.points[k] = {z[0], std::clamp(z[1] + all.shift[k - n], -most, most)};
    }
    voronoi.move(all.points);
  }
  std::copy_n(all.points.begin(), n, points.begin());
}

void relax_across(const SheetPlan& plan, std::vector<Point2>& points, MPI_Comm comm) {
  const double zone = std::min(0.25 * plan.width, 5 * plan.element_size);
  std::vector<std::size_t> near;
  for (std::size_t k = 0; k < points.size(); ++k)
    if (std::abs(points[k][1]) > plan.width / 2 - zone) near.push_back(k);
  relax_some(plan, points, near, comm);
}

Tessellation tessellate_periodic(const SheetPlan& plan, std::span<const Point2> points) {
  const std::size_t n = points.size();
  for (double depth = usual_depth(plan);; depth = std::min(2 * depth, plan.width)) {
    const Repeated all = repeated(plan, points, depth);
    for (const auto& [x, y] : all.points)
      if (!(std::abs(x) <= plan.length / 2 && std::abs(y) <= all.plan.width / 2))
        throw InputError("sheet: a generator of the mesh lies outside the plan");
    const auto order = hilbert_order(all.points, all.plan.length, all.plan.width);
    Voronoi voronoi(all.plan, permuted(all.points, order), Share());
    const Tessellation cells = voronoi.finish(order);
    if (covers(cells, n, all.plan.width / 2)) {
      if (auto own = cells_of_originals(cells, all, n)) {
        double energy = 0, move = 0;
        for (std::size_t k = 0; k < order.size(); ++k) {
          if (static_cast<std::size_t>(order[k]) >= n) continue;
          const Cell& cell = voronoi.cells()[k];
          const Point2& z = voronoi.generators()[k];
          energy += cell.energy;
          move = std::max(move, std::hypot(cell.centroid[0] - z[0], cell.centroid[1] - z[1]));
        }
        const double area = plan.area();
        own->energy_ratio =
            energy * static_cast<double>(n) / (5 / (18 * std::numbers::sqrt3) * area * area);
        own->largest_move = move / plan.element_size;
        return std::move(*own);
      }
    }
    if (depth >= plan.width)
      throw InputError("sheet: width: " + std::to_string(plan.width) +
                       " m is so little for a periodic sheet that cells meet others at both sides;"
                       " make it more, or sheet: element_size less");
  }
}

}  // namespace floe::mesh
