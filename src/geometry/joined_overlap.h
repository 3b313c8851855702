/// \file
/// The overlap of a convex polyhedron with several convex parts that meet at common faces.
///
/// The volume, S and the sums of r x dA of the whole are those of the parts, since a common face
/// counts twice with opposite normals. What is integrated over |dA| (Overlap::patch) leaves common
/// faces out.
#pragma once

#include <span>
#include <vector>

#include "floe/base/rotation.h"
#include "geometry/overlap.h"

namespace floe {

/// Sums overlaps. All vectors are in one frame. An object keeps its working memory.
class JoinedOverlap {
 public:
  void clear();
  /// Adds the overlap with a part, with its facets on this part.
  /// \param axes, origin  frame of the facets
  void add(const Overlap& overlap, const FacetsOnB& facets, const Triad<double>& axes,
           const Vec3<double>& origin);
  /// Leaves out the common face of two added parts. \param corners  of what of it lies in A
  void leave_out(std::span<const Vec3<double>> corners);
  /// Returns the overlap with the whole. S is zero where it is rounding: A lies inside.
  Overlap sum(bool with_patch);

 private:
  struct Edge {
    Vec3<double> a, b, along;  ///< a unit vector
    double length;
  };
  Patch patch(const Vec3<double>& n);
  void join_edges();

  std::vector<Overlap> parts_;
  std::vector<Vec3<double>> corners_;  ///< of triangles
  std::vector<double> weights_;        ///< of the triangles' |dA|
  std::vector<Edge> edges_;
};

}  // namespace floe
