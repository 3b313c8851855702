/// \file
/// Cells that end on the lines of cuts (model.md, "Sheet, mesh, bodies").
#pragma once

#include <mpi.h>

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "floe/mesh/tessellation.h"

namespace floe {

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
/// \param plan  rectangular
/// \param cells  of the relaxed plan; returned as they are if no line can be followed
FittedCells fit_to_cuts(const SheetPlan& plan, Tessellation cells, std::span<const CutLine> lines,
                        MPI_Comm comm);

/// A rectangle that is meshed first: that of a polygon of the outline with a margin, or the polygon
/// itself.
struct MeshedBox {
  SheetPlan plan;  ///< rectangular
  std::array<double, 2> centre{};
  std::array<double, 2> axis{1, 0};  ///< direction of its length
  bool is_polygon = false;           ///< whether all of its cells are kept
};
/// Whether a polygon is a single cell as it is: convex, of 12 corners at most, of the area of one
/// and a half hexagons of the mean cell area at most, and nowhere longer than 3 l. \param l element
/// size [m]
bool is_one_cell(const RingedPolygon& polygon, double l);

/// Number of cells, one behind the other, of a polygon in which rows of cells along its edges find
/// no room: one and a half hexagons each, 1 if it is a single cell. 0: rows find room, or it is not
/// convex, or larger than 20 hexagons.
/// \param plan  element_size and seed are used
int cells_in_a_row(const RingedPolygon& polygon, const SheetPlan& plan);

/// Whether rows of cells find room along all edges of a polygon, or it is a single cell.
/// \param plan  element_size and seed are used
bool can_be_followed(const RingedPolygon& polygon, const SheetPlan& plan);

/// Returns the rectangles of a sheet, one per polygon of its outline, whose sides are multiples of
/// the element size; that of a plan without outline is the plan, and that of a polygon with
/// PolygonPlan::rectangle is this.
std::vector<MeshedBox> meshed_boxes(const SheetPlan& plan);

/// Meshes these rectangles, those of one size, element size and seed once. Collective.
/// \param on_iteration  as of tessellate()
std::vector<Tessellation> tessellate(const std::vector<MeshedBox>& boxes, MPI_Comm comm,
                                     const std::function<void(int, double)>& on_iteration = {});

/// An edge of an outline on which no row of cells could end.
struct UnfollowedEdge {
  std::size_t polygon = 0, ring = 0, edge = 0;
  CutLine line;
};

struct OutlinedCells {
  Tessellation cells;
  std::vector<std::int32_t> polygon;       ///< of the outline, in which each cell lies
  std::vector<FittedCut> cuts;             ///< one per line
  std::vector<UnfollowedEdge> unfollowed;  ///< where there are any, there are no cells
};

/// Changes the cells of the rectangles so that they end on the edges of the outline, polygon by
/// polygon, and keeps those inside; convex polygons that are small or slender are cells in a row.
/// Lines of cuts are followed inside the other polygons, as by fit_to_cuts. Collective; the same
/// bits for any number of ranks. \param relaxed  cells of the meshed_boxes()
OutlinedCells fit_to_outline(const SheetPlan& plan, std::vector<Tessellation> relaxed,
                             std::span<const CutLine> lines, MPI_Comm comm);

}  // namespace floe
