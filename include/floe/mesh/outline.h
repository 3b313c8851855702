/// \file
/// The outline of a sheet in plan: polygons with holes (model.md, "Sheet, mesh, bodies").
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace floe {

/// A straight cut in plan [m].
struct CutLine {
  std::array<double, 2> from{}, to{};
};

/// The corners of a closed line in plan, the first not repeated [m].
using Ring = std::vector<std::array<double, 2>>;

/// A polygon with holes: the first ring is the outer one.
using RingedPolygon = std::vector<Ring>;

struct PlanBox {
  std::array<double, 2> least{}, most{};  ///< [m]
};

/// Polygons in plan. The outer ring of each is counter-clockwise and its holes are clockwise, so
/// that the ice is to the left of every edge.
class Outline {
 public:
  Outline() = default;
  /// Turns the rings the right way round, and drops corners that repeat the one before.
  explicit Outline(std::vector<RingedPolygon> polygons);

  bool empty() const { return polygons_.empty(); }
  const std::vector<RingedPolygon>& polygons() const { return polygons_; }
  std::size_t corners() const;
  double area() const;                     ///< [m^2]
  std::array<double, 2> centroid() const;  ///< [m]
  PlanBox box() const;
  /// Whether a point lies in one of the polygons.
  bool contains(const std::array<double, 2>& p) const;
  /// Distance of a point from the nearest edge [m].
  double distance(const std::array<double, 2>& p) const;
  /// Returns a number that tells outlines apart (FNV-1a of the coordinates' bits).
  std::uint64_t identity() const;

  /// Returns in a few words why these are no polygons that ice can have (too few corners, rings
  /// that cross themselves or each other, holes outside, polygons that overlap); empty if they are.
  /// Polygons may touch.
  std::string flaw() const;

 private:
  std::vector<RingedPolygon> polygons_;
};

PlanBox box_of(const RingedPolygon& polygon);
bool contains(const RingedPolygon& polygon, const std::array<double, 2>& p);
/// Returns the parts of a line inside a polygon.
std::vector<CutLine> clipped(const RingedPolygon& polygon, const CutLine& line);

/// Two polygons that overlap.
struct OverlappingPolygons {
  std::size_t first = 0, second = 0;
  std::string place;  ///< " near (X, Y)"
};
/// Returns pairs of polygons that overlap by more than `slack` [m].
/// \param most  pairs are enough
std::vector<OverlappingPolygons> find_overlaps(const std::vector<RingedPolygon>& polygons,
                                               double slack, std::size_t most);

/// Names a ring of a polygon: "polygon 2", "polygon 2, hole 1"; just "the polygon" if there is one.
std::string name_of_ring(const Outline& outline, std::size_t polygon, std::size_t ring);

/// An outline with fewer corners.
struct SimplifiedOutline {
  Outline outline;
  double moved = 0;  ///< area between the given and the simplified outline [m^2]
};

/// Whether the corners that are left move so that areas stay what they were, or stay where they
/// are.
enum class Areas { kept, changed };

/// Takes corners out of an outline, the least first, as long as all those taken out lie within
/// `tolerance` of the edge that takes their place; no edges come to cross (Dyken, Daehlen &
/// Sevaldrud 2009, by CGAL). Holes of an area below the tolerance's square are filled. The corners
/// that are left then move so that every polygon keeps its area, and every edge lies in the middle
/// of what it replaces (mesh::restore_areas); fewer are taken out where this would move more than
/// the tolerance, or make edges cross.
/// \param outline  without flaw
/// \param tolerance  [m]; 0: the outline stays
SimplifiedOutline simplified(const Outline& outline, double tolerance, Areas areas = Areas::kept);

}  // namespace floe
