/// \file
/// The submerged parts of the owned bodies for all forces of the water on them: found once per
/// evaluation of a step, or every few steps only (model.md, "Water").
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "forces/force.h"
#include "submersion/follow.h"
#include "submersion/immersion.h"

namespace floe {

/// Step of a body, as a part of its mean thickness, after which its submerged part is found anew.
inline constexpr double largest_move = 0.01;

/// Returns the part. \param force  that needs its shapes \throws InputError if it has none
const Part& require_shapes(const Part& part, std::string_view force);

/// Submerged parts in still water. Outside the evaluations of steps it knows nothing, and forces
/// find what they need by immersion().
///
/// With a pace k > 1 every k-th step finds volume V, moment m and waterplane W of each body. In
/// between they follow to first order from how far the body has shifted and turned since
/// (follow.h). A body that has moved by more than largest_move of its thickness is looked at anew
/// at once, so the error is at most of the second order in that. Steps only count, so a step may
/// change.
class Submersion final : public PreparesSteps<Spatial>,
                         public Commits<Spatial>,
                         public Persists,
                         public KeptParts {
 public:
  /// \param part    with shapes; must outlive this object
  /// \param pace    number of steps
  /// \param shared  whether several forces ask
  /// \param level   of the water, one column; empty: z = 0
  Submersion(const Part& part, int pace, bool shared, TimeTable level = {});

  const Part& part() const { return part_; }
  const Immersion& immersion() const { return immersion_; }
  bool has_pace() const { return pace_ > 1; }
  int pace() const { return pace_; }

  void before_evaluation(const State<Spatial>&) override { open_ = true; }
  void after_evaluation() override { open_ = known_ = false; }
  /// Counts steps.
  void commit(const State<Spatial>&, double) override { since_ = (since_ + 1) % pace_; }
  void persist(Archive& archive) override;
  void read(std::vector<double>& numbers, std::int64_t& steps) const override;
  void write(std::span<const double> numbers, std::int64_t steps) override;
  /// Adds what a back end needs to find submerged parts, unless it is there.
  DeviceWater& describe(DeviceModel& model);

  /// Whether an evaluation of a step is under way, with a pace: at_pace() finds submerged parts.
  bool is_paced() const { return open_ && has_pace(); }
  /// Submerged parts of the bodies of a block, of the moments x and y only.
  Immersion::Lane at_pace(const State<Spatial>& state, std::size_t block) {
    const BlockMotion m = block_motion<false>(immersion_, state, block);
    Immersion::Lane below = since_ == 0 ? find(state, block, m) : follow(state, block, m);
    if (!volumes_.empty()) volumes_[block] = below.volume;
    return below;
  }
  /// Finds those of all bodies, for forces that look at one body at a time.
  void find_all_at_pace(const State<Spatial>& state) {
    for (std::size_t block = 0; block < immersion_.blocks(); ++block) (void)at_pace(state, block);
    volumes_are_kept();
  }
  /// Whether an owned body's submerged part was found anew in this step.
  bool is_new(std::size_t body) const { return (new_[body / lanes] >> body % lanes & 1U) != 0; }

  /// Whether others want the volumes that a force finds for this evaluation.
  bool wants_volumes() const { return open_ && shared_; }
  void keep_volume(std::size_t block, const Lanes& volume) { volumes_[block] = volume; }
  /// Called when all volumes are kept.
  void volumes_are_kept() { known_ = !volumes_.empty(); }
  /// Whether the volumes at this evaluation's state are known.
  bool knows_volumes() const { return known_; }
  const Lanes& volume(std::size_t block) const { return volumes_[block]; }
  double volume_of(std::size_t body) const { return volumes_[body / lanes][body % lanes]; }

 private:
  static constexpr std::size_t numbers = 15;  ///< of a body in an Expansion
  void set_numbers(std::span<const double> rows);
  struct Size {
    Lanes extent2;  ///< square of the distance of the farthest vertex [m^2]
    Lanes most2;    ///< half the square of the largest move [m^2]
  };
  struct FollowedBlock {
    Immersion::Lane now;
    Lanes apart;  ///< > 0 where a body has moved too far to be followed
  };
  Immersion::Lane find(const State<Spatial>& state, std::size_t block, const BlockMotion& m);
  Immersion::Lane follow(const State<Spatial>& state, std::size_t block, const BlockMotion& m);
  Immersion::Lane find_some(const State<Spatial>& state, std::size_t block, const BlockMotion& m,
                            const FollowedBlock& followed);

  const Part& part_;
  Immersion immersion_;
  int pace_;
  bool shared_;
  bool open_ = false, known_ = false;
  std::int64_t since_ = 0;         ///< steps since all were found
  std::vector<Lanes> volumes_;     ///< of the last evaluation [m^3]
  std::vector<std::uint8_t> new_;  ///< per block, a bit per lane
  std::vector<Expansion<Lanes>> expansions_;
  std::vector<Size> sizes_;
};

inline Immersion::Lane Submersion::follow(const State<Spatial>& state, std::size_t block,
                                          const BlockMotion& m) {
  const Followed<Lanes> f = followed(expansions_[block], m.u.z, m.q);
  Immersion::Lane now{f.volume, f.moment};
  where(now.volume < 0.0, now.volume) = 0.0;
  new_[block] = 0;
  // (a + b)^2 <= 2 (a^2 + b^2)
  const Lanes apart = f.shift * f.shift + sizes_[block].extent2 * f.turn2 - sizes_[block].most2;
  if (none_of(apart > 0.0)) [[likely]]
    return now;
  return find_some(state, block, m, {now, apart});
}

}  // namespace floe
