/// \file
/// The mesh of a sheet without end, strip by strip (model.md, "Ice without end").
#pragma once

#include <mpi.h>

#include <cstdint>
#include <initializer_list>
#include <map>
#include <span>
#include <vector>

#include "floe/mesh/tessellation.h"

namespace floe {

/// The cells of one strip, with coordinates from its middle. Cell k has the polygon
/// vertices[offset[k]] ... vertices[offset[k+1]-1], counter-clockwise [m].
struct StripCells {
  std::vector<std::int32_t> offset;
  std::vector<std::array<double, 2>> vertices;
  std::vector<Facet> inside;        ///< between two of its cells, sorted
  std::vector<Facet> to_next;       ///< cells[0] of it and cells[1] of the next one, sorted
  std::vector<std::uint8_t> sides;  ///< SheetSide bits of sides of the sheet
  double energy_ratio = 0;          ///< as Tessellation's, of the strip meshed by itself
};

/// Meshes strips of a sheet whose right side is that of strip 0; strip k + 1 lies to the left of
/// strip k. The cells of a strip depend on the plan and its number only, to the last bit, so a
/// sheet is the same wherever a part of it begins. Each strip is relaxed by itself; then the
/// generators near a joint are relaxed with those of both its strips, and all others at rest, so
/// that no joint is a line along which facets lie. Collective, as tessellate().
class Strips {
 public:
  /// \param plan  of one strip: its length is that of the strip, its seed that of the sheet
  Strips(const SheetPlan& plan, MPI_Comm comm) : plan_(plan), comm_(comm) {}

  /// Number of cells of every strip.
  std::int32_t cells_of_each() const { return static_cast<std::int32_t>(number_of_cells(plan_)); }
  /// The cells of a strip. The reference is valid until forget().
  const StripCells& strip(std::int32_t k);
  /// Frees the strips that are not in a sorted list and not next to its last one.
  void forget(std::span<const std::int32_t> kept);

 private:
  using Points = std::vector<std::array<double, 2>>;
  const Points& relaxed(std::int32_t k);
  /// Generators near the joint of strips k and k + 1, from its middle: first those of k.
  const Points& joint(std::int32_t k);
  double zone() const;
  Points of_joint(std::int32_t k);
  Points settled(std::int32_t strip, std::initializer_list<std::int32_t> joints);

  SheetPlan plan_;
  MPI_Comm comm_;
  std::map<std::int32_t, Points> relaxed_, joints_;
  std::map<std::int32_t, StripCells> cells_;
  std::map<std::int32_t, double> energy_ratio_;
};

}  // namespace floe
