/// \file
/// Places and motions of bodies and obstacles in an evaluation.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "contact/pair.h"
#include "contact/placed.h"
#include "contact/solids.h"
#include "contact_laws/mobility.h"
#include "contact_laws/response.h"
#include "floe/base/item.h"
#include "floe/geometry/periods.h"

namespace floe {

/// Place of a body in the world.
struct Pose {
  Vec3<double> x;  ///< centroid [m]
  Quat<double> q;  ///< principal axes to world
};
/// Place and motion of a body.
struct MovingPose {
  Pose pose;
  Vec3<double> velocity, spin;  ///< [m/s, rad/s], world axes
};

/// Returns an obstacle on its motion.
/// \param position  time of its place [s]
/// \param motion    time of its velocities [s]
Placed place_of(const Obstacle& obstacle, double position, double motion);

/// Returns the image of B that is nearest to A, made in `room`.
const Placed& nearest_image(const Placed& a, const Placed& b, const Periods& periods, Placed& room);

/// Acceleration of a body [m/s^2, rad/s^2].
struct Acceleration {
  Vec3<double> linear{}, angular{};
};

/// The places of the involved bodies, by slot, and of all parts of obstacles in the last
/// evaluation.
class Places {
 public:
  /// \param parts  number of parts of obstacles
  explicit Places(std::size_t parts, const Periods& periods = {})
      : parts_(parts), predicted_parts_(parts), periods_(periods) {}

  /// Begins to count travels, after a new list or new slots.
  void restart(std::size_t slots);
  /// Places bodies and obstacles for an evaluation.
  /// \param involved  the body of each slot
  /// \param bodies    by slot
  /// \param time      of the places [s]
  /// \param motion    of the velocities [s]
  void place(const Solids& solids, std::span<const std::int32_t> involved,
             std::span<const MovingPose> bodies, double time, double motion);

  const Placed& of_slot(std::int32_t slot) const { return item(bodies_, slot); }
  /// Returns what the body in a slot opposes to contacts.
  const BodyMobility& mobility(std::int32_t slot) const { return item(mobility_, slot); }
  const BodyMobility& mobility_of_a(const Pair& pair) const { return mobility(pair.slot_a); }
  const BodyMobility& mobility_of_b(const Pair& pair) const {
    return pair.slot_b < 0 ? of_obstacle_ : mobility(pair.slot_b);
  }
  const Placed& of_a(const Pair& pair) const { return item(bodies_, pair.slot_a); }
  const Placed& of_b(const Pair& pair) const {
    return pair.slot_b < 0 ? parts_[part_number(pair.b)] : item(bodies_, pair.slot_b);
  }
  const Periods& periods() const { return periods_; }
  /// Returns the image of B that is nearest to A. \param room  for its place, if it is not B's own
  const Placed& image_of_b(const Pair& pair, Placed& room) const {
    const Placed& b = of_b(pair);
    return periods_.any() ? nearest_image(of_a(pair), b, periods_, room) : b;
  }
  /// Predicts the velocities of bodies a time after those of the last evaluation, and sets those of
  /// obstacles at the time of the evaluation.
  /// \param after          [s]
  /// \param accelerations  of bodies, by slot
  void predict(const Solids& solids, double after, std::span<const Acceleration> accelerations);
  /// Return the predicted velocities of A and B.
  const BodyVelocity& predicted_a(const Pair& pair) const { return item(predicted_, pair.slot_a); }
  const BodyVelocity& predicted_b(const Pair& pair) const {
    return pair.slot_b < 0 ? predicted_parts_[part_number(pair.b)] : item(predicted_, pair.slot_b);
  }
  /// Returns the time of the last evaluation [s].
  double time() const { return time_; }

 private:
  std::vector<Placed> bodies_;                 ///< per slot
  std::vector<BodyMobility> mobility_;         ///< per slot
  std::vector<Placed> parts_;                  ///< per part of obstacles
  std::vector<BodyVelocity> predicted_;        ///< per slot
  std::vector<BodyVelocity> predicted_parts_;  ///< per part of obstacles
  BodyMobility of_obstacle_{};
  Periods periods_;
  double time_ = 0;
  bool counts_travels_ = false;  ///< place() was called since restart()
};

}  // namespace floe
