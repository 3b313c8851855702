/// \file
/// A Delaunay triangulation that follows moving points. Between sweeps of a relaxation few edges
/// change, so the old topology is kept, checked with exact predicates, and repaired by flips
/// (Lawson 1977). If all triangles still turn left and the hull has not moved, the old topology is
/// a triangulation, and a triangulation that is Delaunay across every edge is the Delaunay
/// triangulation. Otherwise the triangulation is built anew.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "floe/geometry/polyhedron.h"
#include "mesh/share.h"

namespace floe::mesh {

/// Half-edge e = 3 t + k runs from origin(e) to origin(next(e)), with its triangle t on the left.
class Delaunay {
 public:
  /// Triangulates points. The points should be in the order of a space-filling curve. The same
  /// points in the same order give the same numbering of triangles.
  /// \throws InputError if two points coincide
  void build(std::vector<Point2> points);

  /// Moves the first points.size() points; the other points, which contain the hull, stay.
  /// Collective.
  void move(std::span<const Point2> points, const Share& share);

  const std::vector<Point2>& points() const { return points_; }
  std::int32_t triangles() const { return static_cast<std::int32_t>(origin_.size() / 3); }
  std::int32_t origin(std::int32_t e) const { return origin_[e]; }
  std::int32_t twin(std::int32_t e) const { return twin_[e]; }  ///< -1 on the hull
  std::int32_t outgoing(std::int32_t vertex) const { return outgoing_[vertex]; }
  static std::int32_t next(std::int32_t e) { return e % 3 == 2 ? e - 2 : e + 1; }
  static std::int32_t previous(std::int32_t e) { return e % 3 == 0 ? e + 2 : e - 1; }
  /// Returns the next half-edge from the same origin, counter-clockwise.
  std::int32_t turn(std::int32_t e) const { return twin_[previous(e)]; }

  std::int64_t builds() const { return builds_; }  ///< number of triangulations from nothing

 private:
  bool turns_left(std::int32_t triangle) const;
  bool is_delaunay(std::int32_t e) const;
  void flip(std::int32_t e);
  void repair(std::vector<std::int32_t> edges);

  std::vector<Point2> points_;
  std::vector<std::int32_t> origin_, twin_, outgoing_;
  std::int64_t builds_ = 0;
};

}  // namespace floe::mesh
