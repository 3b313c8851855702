/// \file
/// The Voronoi diagram of moving generators, clipped to a rectangle.
///
/// A frame of fixed guard points around the plan closes every cell, so that one generator, or any
/// number on a line, is no special case. The guards stand so far out that their cells never reach
/// into the plan (checked in every update); hence inside the plan the diagram is exactly that of
/// the generators alone.
#pragma once

#include <span>
#include <vector>

#include "floe/mesh/tessellation.h"
#include "mesh/delaunay.h"
#include "mesh/share.h"

namespace floe::mesh {

/// Area, centroid and int |x - z|^2 dA of a cell with the generator z [m^2, m, m^4].
struct Cell {
  double area;
  Point2 centroid;
  double energy;
};

class Voronoi {
 public:
  /// Computes the diagram. Collective.
  /// \param generators  should be in the order of a space-filling curve [m]
  Voronoi(const SheetPlan& plan, std::vector<Point2> generators, const Share& share);

  /// Moves the generators, which stay inside the plan. Collective.
  void move(std::vector<Point2> generators);

  const std::vector<Point2>& generators() const { return generators_; }
  const std::vector<Cell>& cells() const { return cells_; }  ///< at the present generators
  std::int64_t builds() const { return delaunay_.builds(); }

  /// Returns the polygons, facets and sides of the present generators; generator k becomes cell
  /// number[k]. Collective.
  Tessellation finish(std::span<const std::int32_t> number);

 private:
  void frame();
  void update_cells();
  bool cover(std::int32_t first, std::int32_t last);
  void circumcentres(std::int32_t first, std::int32_t last);
  void clip();
  std::uint8_t outcode(const Point2& p) const;
  bool guard_stays_out(std::int32_t e) const;
  void merge_close_vertices();
  double clipped_width(const Point2& p, const Point2& q) const;

  double l_, x1_, y1_;  ///< element size; the plan is [-x1, x1] x [-y1, y1]
  double distance_;     ///< distance of the guards from the plan [m]
  Share share_;
  std::vector<Point2> generators_;
  Delaunay delaunay_;
  std::vector<Point2> centre_;  ///< circumcentre of each triangle
  /// outcode of each circumcentre: SheetSide bits of the sides beyond which it lies
  std::vector<std::uint8_t> out_;
  std::vector<Cell> cells_;
  std::vector<Point2> polygon_, scratch_;
};

/// Returns the order of points along a Hilbert curve over the plan.
std::vector<std::int32_t> hilbert_order(std::span<const Point2> points, double length,
                                        double width);

/// Returns the points in an order: points[order[k]].
std::vector<Point2> permuted(std::span<const Point2> points, std::span<const std::int32_t> order);

}  // namespace floe::mesh
