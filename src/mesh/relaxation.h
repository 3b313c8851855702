/// \file
/// How generators are moved until their cells are alike.
#pragma once

#include "mesh/voronoi.h"

namespace floe::mesh {

using OnIteration = std::function<void(int, double)>;

/// Both move the generators of `voronoi` until plan.iterations or plan.tolerance is reached.
/// Collective; the same bits on every rank and for any number of ranks. \return sweeps, or
/// evaluations
int lloyd(Voronoi& voronoi, const SheetPlan& plan, const OnIteration& on_iteration);
int quasi_newton(Voronoi& voronoi, const SheetPlan& plan, const OnIteration& on_iteration);

/// Largest distance between a generator and its cell's centroid [m].
double largest_move(const Voronoi& voronoi);

}  // namespace floe::mesh
