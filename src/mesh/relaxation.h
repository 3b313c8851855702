/// \file
/// The relaxations of a mesh: motion of generators towards the centroids of their cells.
#pragma once

#include "mesh/voronoi.h"

namespace floe::mesh {

using OnIteration = std::function<void(int, double)>;

/// Move the generators of `voronoi` until plan.iterations or plan.tolerance is reached. Collective;
/// the same bits on every rank and for any number of ranks.
/// \param on_iteration  as in tessellate()
/// \return number of sweeps (lloyd) or evaluations (quasi_newton)
int lloyd(Voronoi& voronoi, const SheetPlan& plan, const OnIteration& on_iteration);
int quasi_newton(Voronoi& voronoi, const SheetPlan& plan, const OnIteration& on_iteration);

/// Returns the largest distance between a generator and its cell's centroid [m].
double largest_move(const Voronoi& voronoi);

}  // namespace floe::mesh
