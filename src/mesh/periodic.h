/// \file
/// Meshes of plans that repeat themselves in y (model.md, "Sheet, mesh, bodies").
#pragma once

#include <mpi.h>

#include <span>
#include <vector>

#include "floe/mesh/tessellation.h"
#include "mesh/delaunay.h"

namespace floe::mesh {

/// Does plan.iterations sweeps of Lloyd's algorithm with some of the generators, all others at
/// rest. In a periodic plan the images of those that move go with them. Collective.
/// \param moving  indices of the generators that move
void relax_some(const SheetPlan& plan, std::vector<Point2>& points,
                std::span<const std::size_t> moving, MPI_Comm comm);

/// Relaxes the generators of a rectangle near its bottom and top sides across these, so that the
/// seam of the periodic plan is no line of facets. Collective.
void relax_across(const SheetPlan& plan, std::vector<Point2>& points, MPI_Comm comm);

/// As tessellate(plan, generators), of a periodic plan.
Tessellation tessellate_periodic(const SheetPlan& plan, std::span<const Point2> points);

}  // namespace floe::mesh
