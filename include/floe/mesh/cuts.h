/// \file
/// Cells that end on the lines of cuts (model.md, "Sheet, mesh, bodies").
#pragma once

#include <mpi.h>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "floe/mesh/tessellation.h"

namespace floe {

/// A straight cut in plan [m].
struct CutLine {
  std::array<double, 2> from{}, to{};
};

/// What became of one cut.
struct FittedCut {
  /// The two cells, the smaller first, at each facet on the line.
  std::vector<std::array<std::int32_t, 2>> pairs;
  double length = 0;    ///< of the line inside the plan [m]
  double followed = 0;  ///< sum of the widths of the facets on the line [m]
};

struct FittedCells {
  Tessellation cells;
  std::vector<FittedCut> cuts;  ///< one per line
};

/// Changes the cells near lines so that facets lie on the lines from end to end: pairs of
/// generators that are images of each other in the line take the place of generators near it, and
/// the others near it relax once more. Cells far from all lines keep their generators. Lines may
/// meet, cross and end on the outline or inside. A line (or its part between two others) is left
/// as it is where it would need cells much smaller than the element size: shorter than 0.4 l, or
/// too close to another line or to the outline. Collective; the same bits for any number of ranks.
/// \param cells  of the relaxed plan; returned as they are if no line can be followed
FittedCells fit_to_cuts(const SheetPlan& plan, Tessellation cells, std::span<const CutLine> lines,
                        MPI_Comm comm);

}  // namespace floe
