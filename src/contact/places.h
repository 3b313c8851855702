/// \file
/// Places and motions of bodies and obstacles in an evaluation.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "contact/pair.h"
#include "contact/solids.h"
#include "contact_laws/response.h"
#include "floe/base/item.h"

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

/// Place and motion of a body or obstacle in an evaluation.
struct Placed {
  Vec3<double> x;           ///< centroid, or origin of the frame of an obstacle [m]
  Triad<double> axes;       ///< of its frame
  Vec3<double> velocity{};  ///< [m/s]
  Vec3<double> spin{};      ///< [rad/s]
  double travelled = 0;     ///< bound of the travel of its points since the last build [m]
};

/// Returns an obstacle on its motion.
/// \param position  time of its place [s]
/// \param motion    time of its velocities [s]
Placed place_of(const Obstacle& obstacle, double position, double motion);

/// Returns the motion of A relative to B at a point.
/// \param centre  the point, from the centroid of A [m]
inline RelativeMotion relative_motion(const Placed& a, const Placed& b,
                                      const Vec3<double>& centre) {
  const Vec3<double> arm = centre + (a.x - b.x);
  return {.velocity = (a.velocity + cross(a.spin, centre)) - (b.velocity + cross(b.spin, arm)),
          .spin = a.spin - b.spin};
}

/// The places of the involved bodies, by slot, and of all obstacles in the last evaluation.
class Places {
 public:
  /// \param obstacles  number of obstacles
  explicit Places(std::size_t obstacles) : obstacles_(obstacles) {}

  /// Begins to count travels, after a new list or new slots.
  void restart(std::size_t slots);
  /// Places bodies and obstacles for an evaluation.
  /// \param involved  the body of each slot
  /// \param bodies    by slot
  /// \param time      of the places [s]
  /// \param motion    of the velocities [s]
  void place(const Solids& solids, std::span<const std::int32_t> involved,
             std::span<const MovingPose> bodies, double time, double motion);
  /// Gives obstacles their velocities at a time; their places stay.
  void set_obstacle_velocities(const Solids& solids, double time);

  const Placed& of_slot(std::int32_t slot) const { return item(bodies_, slot); }
  const Placed& of_a(const Pair& pair) const { return item(bodies_, pair.slot_a); }
  const Placed& of_b(const Pair& pair) const {
    return is_obstacle(pair.b) ? obstacles_[obstacle_number(pair.b)] : item(bodies_, pair.slot_b);
  }
  /// Returns a body at its place of the evaluation with a later velocity and spin; without axes.
  Placed moving(std::int32_t slot, const MovingPose& later) const {
    return {item(bodies_, slot).x, {}, later.velocity, later.spin};
  }
  /// Returns an obstacle at its place of the evaluation with its velocities at that time.
  Placed obstacle_now(const Solids& solids, std::int32_t index) const {
    Placed now = obstacles_[obstacle_number(index)];
    const ObstacleMotion& motion = solids.obstacle(index).motion;
    if (motion.at_rest()) return now;
    now.velocity = motion.rate(time_);
    now.spin = motion.spin(time_);
    return now;
  }
  /// Returns the time of the last evaluation [s].
  double time() const { return time_; }

 private:
  void move(Placed& solid, const Placed& to, double radius) const;

  std::vector<Placed> bodies_;     ///< per slot
  std::vector<Placed> obstacles_;  ///< per obstacle
  double time_ = 0;
  bool counts_travels_ = false;  ///< place() was called since restart()
};

}  // namespace floe
