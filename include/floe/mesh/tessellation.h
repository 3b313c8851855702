/// \file
/// Centroidal Voronoi tessellation of a rectangular sheet (model.md section 1; paper, "Mesh
/// Creation").
#pragma once

#include <mpi.h>

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

namespace floe {

/// How generators are moved towards the centroids of their cells.
enum class Relaxation {
  lloyd,         ///< Lloyd's algorithm (Du et al. 1999): each generator to its cell's centroid; the
                 ///< paper's.
  quasi_newton,  ///< L-BFGS on the CVT energy (Liu et al. 2009): far fewer evaluations.
};

/// A sheet's plan, centred on the origin, and how it is meshed. Lengths in m.
struct SheetPlan {
  double length = 40;       ///< extent in x
  double width = 40;        ///< extent in y
  double element_size = 2;  ///< l, flat-to-flat size of the regular hexagon of the mean cell area
  std::uint64_t seed =
      1;  ///< of the random generators; same seed, same mesh, on any number of ranks
  Relaxation relaxation = Relaxation::lloyd;
  int iterations = 150;  ///< at most so many sweeps, or evaluations (a line search is finished)
  double tolerance = 0;  ///< stop when no generator moves by more than this times l (0: never)
};

/// N = ceil(2 Lx Ly / (sqrt(3) l^2)) [model.md section 1].
std::int64_t number_of_cells(const SheetPlan& plan);

enum SheetSide : std::uint8_t { side_left = 1, side_right = 2, side_bottom = 4, side_top = 8 };

/// A straight edge shared by two cells, cells[0] < cells[1].
struct Facet {
  std::array<std::int32_t, 2> cells;
  double width;  ///< [m]
};

/// A tessellation clipped to the plan. Cell k's polygon is convex, counter-clockwise:
/// vertices[offset[k]] ... vertices[offset[k+1]-1]. Sums of cell areas equal the plan's to
/// rounding.
struct Tessellation {
  std::vector<std::array<double, 2>> generators;  ///< n, where the relaxation left them
  std::vector<std::int32_t> offset;               ///< n+1
  std::vector<std::array<double, 2>> vertices;    ///< of all polygons [m]
  std::vector<Facet> facets;                      ///< sorted by cells; none shorter than 1e-9 l
  std::vector<std::uint8_t> sides;                ///< n, SheetSide bits: the cell has an edge there
  double energy_ratio = 0;  ///< CVT energy over that of N regular hexagons of the same total area
  double largest_move = 0;  ///< largest |centroid - generator| over l, of these cells
  int iterations = 0;       ///< Lloyd sweeps, or energy evaluations of quasi_newton
  std::int64_t degenerate =
      0;  ///< Delaunay edges dropped because their facet has (almost) no width;
          ///< the vertices at its ends are one, so polygons have no such edge
};

/// Meshes a plan; collective, the result is whole and bitwise the same on every rank and for any
/// number of ranks. Cells are numbered along a Hilbert curve over the plan. PETSc's options of the
/// quasi-Newton solver have the prefix mesh_ (-mesh_tao_monitor). \param on_iteration  called after
/// each sweep with its number and the largest move over l; by quasi_newton
///                      after each accepted step, with the number of evaluations so far (may be
///                      empty)
/// \throws InputError if there would be more than 1e8 cells
Tessellation tessellate(const SheetPlan& plan, MPI_Comm comm,
                        const std::function<void(int, double)>& on_iteration = {});

/// The tessellation of given generators, without relaxation (degenerate arrangements included).
/// Cell k is that of generator k. Not collective.
/// \param plan  length, width and element_size are used
/// \throws InputError if two generators coincide or one lies outside the plan
Tessellation tessellate(const SheetPlan& plan, std::vector<std::array<double, 2>> generators);

}  // namespace floe
