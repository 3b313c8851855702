/// \file
/// The overlap of a convex polyhedron with several convex parts that meet at common faces.
///
/// The volume, S and the sums of r x dA of the whole are those of the parts, since a common face
/// counts twice with opposite normals. What is integrated over |dA| (Overlap::patch) leaves common
/// faces out.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "floe/base/rotation.h"
#include "geometry/overlap.h"

namespace floe {

/// Sums overlaps. An object keeps its working memory.
class JoinedOverlap {
 public:
  void clear();
  /// Adds the overlap with a part, with its facets on this part.
  void add(const Overlap& overlap, const FacetsOnB& facets);
  /// Leaves out the common face of two added parts. \param corners  of what of it lies in A
  void leave_out(std::span<const Vec3<double>> corners);
  /// Returns the overlap with the whole. S is zero where it is rounding: A lies inside.
  Overlap sum(bool with_patch) const;

 private:
  struct Edge {
    Vec3<double> a, b, normal;
  };
  Patch patch(const Vec3<double>& n) const;
  std::vector<Edge> whole_edges() const;

  struct Facet {
    std::size_t begin, end;  ///< corners
    double weight;           ///< of |dA|
  };
  std::vector<Overlap> parts_;
  std::vector<Vec3<double>> corners_;
  std::vector<Facet> facets_;
};

}  // namespace floe
