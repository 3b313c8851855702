/// \file
/// Centroidal Voronoi tessellation of a sheet (model.md, "Sheet, mesh, bodies"; paper, "Mesh
/// Creation").
#pragma once

#include <mpi.h>

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "floe/mesh/outline.h"

namespace floe {

/// The method that moves generators towards the centroids of their cells.
enum class Relaxation {
  /// Lloyd's algorithm (Du et al. 1999), the paper's: each generator to its cell's centroid
  lloyd,
  quasi_newton,  ///< L-BFGS on the CVT energy (Liu et al. 2009): far fewer evaluations
};

/// How a polygon of an outline is meshed, where polygons differ.
struct PolygonPlan {
  /// A rectangle that is meshed as a sheet by itself, then turned and moved to its place.
  struct Rectangle {
    double length = 0, width = 0;      ///< [m]
    std::array<double, 2> centre{};    ///< [m]
    std::array<double, 2> axis{1, 0};  ///< direction of its length, a unit vector
  };
  double element_size = 2;
  std::uint64_t seed = 1;
  std::optional<Rectangle> rectangle{};  ///< if the polygon is one
};

/// The plan of a sheet and the parameters of its mesh. Lengths in m.
struct SheetPlan {
  double length = 40;       ///< extent in x, of a rectangle centred on the origin or of `outline`
  double width = 40;        ///< extent in y
  double element_size = 2;  ///< l, flat-to-flat size of the regular hexagon of the mean cell area
  /// seed of the random generators; the same seed gives the same mesh on any number of ranks
  std::uint64_t seed = 1;
  Relaxation relaxation = Relaxation::lloyd;
  int iterations = 150;  ///< limit of sweeps, or of evaluations (a line search is finished)
  double tolerance = 0;  ///< stop when no generator moves by more than this times l (0: never)
  Outline outline{};     ///< the sheet; empty: the rectangle
  /// of each polygon of the outline; empty: all have element_size and seed
  std::vector<PolygonPlan> of_polygon{};
  /// The rectangle goes on beyond its bottom and top sides, as itself: cells next to one of them
  /// have facets with images of cells next to the other, and reach across the side.
  bool periodic = false;

  /// Element size in a polygon of the outline [m].
  double size_of(std::int32_t polygon) const {
    return of_polygon.empty() ? element_size
                              : of_polygon[static_cast<std::size_t>(polygon)].element_size;
  }
  double area() const { return outline.empty() ? length * width : outline.area(); }  ///< [m^2]
};

/// Returns the number of cells N = ceil(2 A / (sqrt(3) l^2)) (model.md, "Sheet, mesh, bodies"), for
/// an outline about.
std::int64_t number_of_cells(const SheetPlan& plan);

enum SheetSide : std::uint8_t { side_left = 1, side_right = 2, side_bottom = 4, side_top = 8 };

/// A straight edge shared by two cells, cells[0] < cells[1].
struct Facet {
  std::array<std::int32_t, 2> cells;
  double width;      ///< [m]
  double shift = 0;  ///< along y, from cells[1] to its image at the facet, of a periodic plan [m]
};

/// A tessellation of the plan. Cell k has the convex polygon vertices[offset[k]] ...
/// vertices[offset[k+1]-1], counter-clockwise. The cell areas sum to that of the plan, to rounding.
struct Tessellation {
  std::vector<std::array<double, 2>> generators;  ///< n, final positions
  std::vector<std::int32_t> offset;               ///< n+1
  std::vector<std::array<double, 2>> vertices;    ///< of all polygons [m]
  std::vector<Facet> facets;                      ///< sorted by cells; none shorter than 1e-9 l
  /// n, SheetSide bits of the sides on which the cell has an edge: of an outline, each edge is on
  /// the side whose direction is nearest to its outward normal
  std::vector<std::uint8_t> sides;
  double energy_ratio = 0;  ///< CVT energy over that of N regular hexagons of the same total area
  double largest_move = 0;  ///< largest |centroid - generator| over l, of these cells
  int iterations = 0;       ///< Lloyd sweeps, or energy evaluations of quasi_newton
  /// Delaunay edges dropped because their facet has (almost) no width; the vertices at the ends of
  /// such a facet are merged, so polygons have no such edge
  std::int64_t degenerate = 0;
};

/// Meshes a rectangular plan. Collective; the result is whole and bitwise the same on every rank
/// and for any number of ranks. Cells are numbered along a Hilbert curve over the plan. PETSc's
/// options of the quasi-Newton solver have the prefix mesh_ (-mesh_tao_monitor). \param
/// on_iteration  called after each sweep with its number and the largest move over l; by
/// quasi_newton after each accepted step, with the number of evaluations so far (may be empty)
/// \throws InputError if there would be more than 1e8 cells, or if a periodic plan is so narrow
/// that
///   cells meet others at both sides
Tessellation tessellate(const SheetPlan& plan, MPI_Comm comm,
                        const std::function<void(int, double)>& on_iteration = {});

/// Returns the tessellation of given generators, without relaxation. Degenerate arrangements are
/// allowed. Cell k is that of generator k. Not collective.
/// \param plan  length, width, element_size and periodic are used
/// \throws InputError if two generators coincide or one lies outside the plan (beyond its left and
///   right sides, if it is periodic), or as above
Tessellation tessellate(const SheetPlan& plan, std::vector<std::array<double, 2>> generators);

/// An edge of a cell that no other cell shares, with the cell to its left.
struct BoundaryEdge {
  std::int32_t cell;
  std::array<double, 2> from, to;  ///< [m]
};
/// Returns the edges on the outline, cell by cell.
std::vector<BoundaryEdge> boundary_edges(const Tessellation& cells);

}  // namespace floe
