/// \file
/// The list of the pairs that may touch before some vertex has moved by the slack of the list
/// (model.md, "Contact").
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "contact/eligibility.h"
#include "contact/narrow_phase.h"
#include "contact/pair.h"
#include "contact/places.h"
#include "contact/solids.h"
#include "floe/base/item.h"

namespace floe {

/// The pairs of one rank, sorted by (A, B), those of the same two obstacles one after the other,
/// and the pairs that this rank has taken on from other ranks. The bodies in all these pairs are
/// involved; their places in the sorted list of involved bodies are the slots.
class PairList {
 public:
  /// \param joined       pairs with an unbroken beam, sorted, the smaller index first
  /// \param stress_free  whether overlaps before the first step count as stress-free
  /// \param periods      of the model
  PairList(const Solids& solids, std::vector<BodyPair> joined, bool stress_free,
           const Periods& periods = {});

  /// Returns the distance that a vertex may travel between two builds [m]: half the reach.
  double slack() const { return 0.5 * reach_; }
  /// Returns the largest gap of a listed pair [m].
  double reach() const { return reach_; }
  /// Whether a body touches nothing as ice at present.
  bool is_left_out(const Solids& solids, std::int32_t body) const {
    const bool intact = eligibility_.pieces() == 1;  // only bodies on the surface may touch
    return (intact && !eligibility_.on_surface(body)) || solids.carries(body);
  }
  /// Whether pairs may have become eligible since the last build.
  bool changed() const { return changed_; }
  /// Pieces and released pairs.
  const Eligibility& eligibility() const { return eligibility_; }

  /// Lists the pairs that may touch before some vertex has moved by slack().
  /// \param poses  of all bodies
  /// \param here   per body: 1 if this rank needs its wrench
  /// \param time   of the poses [s]
  void build(const Solids& solids, NarrowPhase& narrow, std::span<const Pose> poses,
             std::span<const std::uint8_t> here, double time);
  /// Marks a pair as offloaded until the next build: another rank computes its overlap.
  BodyPair offload(std::int32_t pair);
  /// Takes on pairs of other ranks until the next build: this rank computes their overlaps.
  void take_on(const Solids& solids, std::span<const BodyPair> pairs);
  /// Makes a pair whose beam broke eligible from the next build on; its overlap at that time counts
  /// as stress-free.
  void release(BodyPair pair);
  /// Ends a step: pairs that were newly eligible have their first overlap now.
  void end_step();
  /// Whether a body is near an obstacle: all its vertices are less than a quarter of the reach
  /// beyond each plane of the obstacle. It depends on the state alone, not on when the list was
  /// made. \param place, other  of the body and of the obstacle, without motion
  bool is_near(const Solids& solids, std::int32_t body, const Placed& place, std::int32_t obstacle,
               const Placed& other) const;
  /// Returns the bodies with a wrench here, each with an obstacle, that may become near before the
  /// next build.
  std::span<const BodyPair> may_become_near() const { return may_become_near_; }
  /// Returns the number of released pairs that the list knew at the end of the last step: those
  /// after them have had no first overlap yet, even if they have been evaluated.
  std::size_t settled() const { return settled_; }
  /// Empties the list, for the build after a restart.
  /// \param released  pairs whose beam broke, in the order of release()
  /// \param known     number of these that the last build knew
  void restore(const Solids& solids, std::span<const BodyPair> released, std::size_t known);

  std::size_t size() const { return pairs_.size(); }
  std::span<Pair> pairs() { return pairs_; }
  std::span<const Pair> pairs() const { return pairs_; }
  const Pair& pair(std::int32_t index) const { return item(pairs_, index); }
  std::span<Pair> taken_on() { return taken_on_; }
  /// Returns the involved bodies, by slot: those of the pairs, and all that carry obstacles.
  std::span<const std::int32_t> involved() const { return involved_; }
  /// Returns the slot of an involved body.
  std::int32_t slot_of(std::int32_t body) const {
    const auto found = std::lower_bound(involved_.begin(), involved_.end(), body);
    return static_cast<std::int32_t>(found - involved_.begin());
  }

 private:
  struct Search;
  void list_bodies(const Search& search);
  void list_obstacles(const Search& search);
  void list_touching_obstacles(const Search& search);
  void list(const Search& search, const BodyPair& bodies, const Placed& a, const Placed& b);
  void bring_together(const Solids& solids);
  void find_involved(const Solids& solids);

  Eligibility eligibility_;
  std::vector<Pair> pairs_, taken_on_;
  std::vector<BodyPair> may_become_near_;
  std::vector<std::int32_t> involved_;
  Periods periods_;
  double reach_ = 0;  ///< largest gap of a listed pair [m]
  bool changed_ = true;
  bool stress_free_;  ///< overlaps before the end of the step are stress-free
  std::size_t settled_ = 0;
  bool newly_eligible_ = false;  ///< listed pairs may be newly eligible
};

}  // namespace floe
