#include <algorithm>
#include <cmath>

#include "mesh/relaxation.h"

namespace floe::mesh {

double largest_move(const Voronoi& voronoi) {
  double largest2 = 0;
  for (std::size_t k = 0; k < voronoi.cells().size(); ++k) {
    const Point2 &z = voronoi.generators()[k], &c = voronoi.cells()[k].centroid;
    const double x = c[0] - z[0], y = c[1] - z[1];
    largest2 = std::max(largest2, x * x + y * y);
  }
  return std::sqrt(largest2);
}

int lloyd(Voronoi& voronoi, const SheetPlan& plan, const OnIteration& on_iteration) {
  for (int sweep = 1; sweep <= plan.iterations; ++sweep) {
    const double move = largest_move(voronoi) / plan.element_size;
    std::vector<Point2> centroids(voronoi.cells().size());
    std::transform(voronoi.cells().begin(), voronoi.cells().end(), centroids.begin(),
                   [](const Cell& cell) { return cell.centroid; });
    voronoi.move(std::move(centroids));
    if (on_iteration) on_iteration(sweep, move);
    if (move <= plan.tolerance) return sweep;
  }
  return plan.iterations;
}

}  // namespace floe::mesh
