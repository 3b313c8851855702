/// \file
/// The submerged parts of the owned bodies below waves, for all forces of the water on them.
#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "forces/force.h"
#include "submersion/immersion.h"
#include "submersion/waves.h"

namespace floe {

/// Submersion below the planes of waves, which also tells these planes and the velocities of the
/// water. With a pace planes and velocities, too, follow to first order in between, from the time
/// and from how far the body has moved.
class SubmersionInWaves final : public PreparesSteps<Spatial>,
                                public Commits<Spatial>,
                                public Persists {
 public:
  /// \param part    with shapes; must outlive this object
  /// \param waves   with the current
  /// \param pace    number of steps
  /// \param shared  whether several forces ask
  SubmersionInWaves(const Part& part, Waves waves, int pace, bool shared);

  const Part& part() const { return part_; }
  const Immersion& immersion() const { return immersion_; }
  const Waves& waves() const { return waves_; }
  bool has_pace() const { return pace_ > 1; }

  void before_evaluation(const State<Spatial>& state) override;
  void after_evaluation() override { known_ = false; }
  /// Counts steps.
  void commit(const State<Spatial>&, double) override { since_ = (since_ + 1) % pace_; }
  void persist(Archive& archive) override;

  /// Whether an evaluation of a step is under way, with a pace.
  bool is_paced() const { return known_ && has_pace(); }
  /// They are found before the evaluation.
  void find_all_at_pace(const State<Spatial>&) {}
  /// Whether an owned body's submerged part was found anew in this step.
  bool is_new(std::size_t body) const { return now_[body].is_new; }

  /// Whether an evaluation of a step is under way of which the following are known.
  bool knows_volumes() const { return known_; }
  const SurfacePlane& plane(std::size_t body) const { return now_[body].plane; }
  const Vec3<double>& water(std::size_t body) const { return now_[body].water; }
  /// Moments are in the axes of SurfacePlane::to_level(); no waterplane.
  const Submerged& below(std::size_t body) const { return now_[body].below; }
  double volume_of(std::size_t body) const { return now_[body].below.volume; }

 private:
  struct Now {
    SurfacePlane plane;
    Vec3<double> water;  ///< velocity [m/s]
    Submerged below;
    bool is_new = true;
  };
  /// What was found, where and when: centroid, time, and in the level axes height and rotation.
  struct Expansion {
    Vec3<double> at;
    double time;
    SurfacePlane plane;
    Vec3<double> water;
    Waves::Change change;
    double z;
    Quat<double> q;
    Submerged below;
  };
  static constexpr std::size_t numbers = 34;  ///< of a body in an Expansion
  static std::array<double*, numbers> numbers_of(Expansion& e);
  void find(const State<Spatial>& state, std::int32_t body);
  void follow(const State<Spatial>& state, std::int32_t body);
  static std::pair<double, Quat<double>> in_level_axes(const SurfacePlane& plane, double z,
                                                       const Quat<double>& q);

  const Part& part_;
  Immersion immersion_;
  Waves waves_;
  int pace_;
  bool shared_;
  bool known_ = false;
  std::int64_t since_ = 0;  ///< steps since all were found
  std::vector<Now> now_;
  std::vector<Expansion> expansions_;
  std::vector<double> most2_;  ///< half the square of the largest move of a body [m^2]
};

}  // namespace floe
