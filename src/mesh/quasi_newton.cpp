#include <petsctao.h>

#include <algorithm>

#include "mesh/relaxation.h"

namespace floe::mesh {
namespace {

/// The CVT energy in the solver's units: lengths in l, energy in (plan area / N) l^2 / 2, so that a
/// unit step along the negative gradient (m/mean m)(z - c) is about one Lloyd move.
struct Problem {
  Voronoi& voronoi;
  double l, mean_area;
  double energy = 0;
  std::vector<double> gradient;
  int evaluations = 0;
};

}  // namespace

int quasi_newton(Voronoi& voronoi, const SheetPlan& plan, const OnIteration& on_iteration) {
  (void)on_iteration;
  (void)plan;
  (void)voronoi;
  return 0;
}

}  // namespace floe::mesh
