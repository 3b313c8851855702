/// \file
/// The narrow phase: gaps and overlaps of pairs at their places.
#pragma once

#include <vector>

#include "contact/pair.h"
#include "contact/pair_overlap.h"
#include "contact/places.h"
#include "contact/solids.h"
#include "contact/wear.h"
#include "geometry/graph_clipper.h"
#include "geometry/overlap.h"

namespace floe {

/// How far A reaches down and B reaches up along an axis from B to A, each from its own origin.
struct Reaches {
  double low_of_a = 0, high_of_b = 0;  ///< [m]
};
/// Returns the reaches of a pair along a unit vector.
Reaches reaches(const Solids& solids, const Pair& pair, const Placed& a, const Placed& b,
                const Vec3<double>& axis);

/// Looks at one pair at a time. An object keeps its working memory, so that calls do not allocate
/// once the memory has grown.
class NarrowPhase {
 public:
  /// \param with_patch  whether overlaps have their Overlap::patch
  explicit NarrowPhase(bool with_patch) : with_patch_(with_patch) {}

  /// Returns a gap of a pair, at the face or along the axis of its last gap or at a better one that
  /// replaces it [m]. Not positive: no gap was found, which does not prove an overlap.
  /// \param enough  a gap that is wider is not bettered [m]
  /// \param tries   largest number of axes after all faces
  double gap(const Solids& solids, Pair& pair, const Placed& a, const Placed& b, double enough,
             int tries);

  /// Whether a pair is known to have a gap. A gap that is found counts until the travels of A and B
  /// may have closed it.
  bool is_apart(const Solids& solids, Pair& pair, const Placed& a, const Placed& b) {
    return a.travelled + b.travelled < pair.safe || has_gap(solids, pair, a, b);
  }

  /// Returns the overlap of what wear has left of a pair.
  PairOverlap overlap(const Solids& solids, const Wear& wear, Pair& pair, const Placed& a,
                      const Placed& b) {
    PairOverlap met;
    overlap(solids, wear, pair, a, b, met);
    return met;
  }
  /// Sets the same. \param met  overwritten
  void overlap(const Solids& solids, const Wear& wear, Pair& pair, const Placed& a, const Placed& b,
               PairOverlap& met);
  /// Whether overlaps have their Overlap::patch.
  bool with_patch() const { return with_patch_; }
  /// Sets the facets on B of the last overlap, which was not zero. \param pair  of it
  void facets_on_b(const Pair& pair, FacetsOnB& facets) const;
  /// Forgets the records of cuts of all pairs, for a new list. No number depends on them.
  void forget_cuts() { records_.clear(); }

 private:
  void clip(const Solids& solids, Pair& pair, const Triad<double>& turn, const Vec3<double>& x,
            const FurtherPlanes& further, Overlap& found);
  CutRecord& record_of(Pair& pair);
  bool has_gap(const Solids& solids, Pair& pair, const Placed& a, const Placed& b);

  bool with_patch_;
  bool by_graph_ = false;  ///< the last overlap was the graph clipper's
  GraphClipper graph_clipper_;
  Clipper clipper_;                 ///< for the few pairs that are too much for the other
  std::vector<CutRecord> records_;  ///< of the pairs that overlapped since the last list
  std::vector<Vec3<double>> vertices_a_, vertices_b_;  ///< work space: placed vertices
  std::vector<HalfSpace> worn_;                        ///< work space: placed planes
};

}  // namespace floe
