/// \file
/// The contacts of a body A with an obstacle of several parts, or of two obstacles.
///
/// A law acts on a whole contact, not on parts: the overlaps of A with parts that meet inside A are
/// one contact, and so are those of parts of A that meet inside a part of B. Overlaps that do not
/// meet, as with opposite walls, are contacts of their own. So forces do not depend on how a shape
/// is cut into parts.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "contact/narrow_phase.h"
#include "contact/pair.h"
#include "contact/solids.h"
#include "contact/wear.h"
#include "geometry/joined_overlap.h"

namespace floe {

/// Joins the overlaps of one body, or of the parts of an obstacle, with the parts of another
/// obstacle. An object keeps its working memory.
class PartContacts {
 public:
  /// A contact.
  struct Joined {
    std::int32_t pair = -1;  ///< index of the pair that stands for it
    PairOverlap overlap;
    std::vector<std::int32_t> known;  ///< indices of the pairs whose histories it goes on with
  };

  /// Begins with a body or obstacle A and an obstacle B.
  void start() { number_ = 0; }
  /// Adds an overlap that is not zero, the last one of `narrow`.
  /// \param index  of the pair in the list, ascending
  void add(std::int32_t index, const Pair& pair, const PairOverlap& overlap,
           const NarrowPhase& narrow);
  /// Returns the contacts of the overlaps, in the order of `pair`.
  /// \param pairs  of the list
  /// \param a, b   places of A and B
  /// \param known  indices of the pairs of A and B with a history, ascending
  std::span<const Joined> join(const Solids& solids, const Wear& wear, bool with_patch,
                               std::span<const Pair> pairs, const Placed& a, const Placed& b,
                               std::span<const std::int32_t> known);

 private:
  struct Met {
    std::int32_t pair = -1;
    std::size_t contact = 0;  ///< number of the contact
    PairOverlap overlap;
    FacetsOnB facets;
  };
  /// What of a common face of two parts lies in A, in the frame of the obstacle.
  struct Meeting {
    std::size_t part = 0;  ///< one of the two, of met()
    std::vector<Vec3<double>> corners;
  };

  std::size_t find_meetings(const Solids& solids, const Wear& wear, std::span<const Pair> pairs,
                            const Placed& a, const Placed& b);
  void find_meetings_in_a(const Solids& solids, std::span<const Pair> pairs, std::size_t one);
  void find_meetings_in_b(const Solids& solids, std::span<const Pair> pairs, std::size_t one);
  bool is_inside(std::span<const HalfSpace> planes);
  void unite(std::size_t one, std::size_t other);
  void choose_pairs(const Solids& solids, std::span<const Pair> pairs,
                    std::span<const std::int32_t> known, std::span<Joined> contacts);
  void sum(const Solids& solids, std::span<const Pair> pairs, bool with_patch, const Placed& a,
           const Placed& b, std::size_t contact);

  std::span<Met> met() { return {room_.data(), number_}; }

  std::vector<Met> room_;  ///< its first entries are in use
  std::size_t number_ = 0;
  std::vector<Meeting> meeting_room_;
  std::size_t meetings_ = 0;  ///< of its entries are in use
  std::vector<Joined> joined_;
  JoinedOverlap whole_;
  std::vector<Vec3<double>> corners_, work_;
  std::vector<HalfSpace> planes_a_;  ///< of a body or part A, in the frame of B
  std::vector<HalfSpace> planes_b_;  ///< of a part of B, in the frame of A
};

}  // namespace floe
