#include "contact/places.h"

#include <cmath>

namespace floe {
namespace {

/// Returns a bound of the travel of all points within `radius` of the origin of a frame [m].
double farthest_travel(const Placed& from, const Placed& to, double radius) {
  const Vec3<double> d1 = to.axes.e1 - from.axes.e1, d2 = to.axes.e2 - from.axes.e2,
                     d3 = to.axes.e3 - from.axes.e3;
  return length(to.x - from.x) + radius * std::sqrt(dot(d1, d1) + dot(d2, d2) + dot(d3, d3));
}

}  // namespace

Placed place_of(const Obstacle& obstacle, double position, double motion) {
  return {.x = obstacle.point + obstacle.motion.way(position),
          .axes = triad(obstacle.motion.turn(position)),
          .velocity = obstacle.motion.rate(motion),
          .spin = obstacle.motion.spin(motion)};
}

const Placed& nearest_image(const Placed& a, const Placed& b, const Periods& periods,
                            Placed& room) {
  room = b;
  room.x = a.x - periods.nearest(a.x - b.x);
  return room;
}

void Places::restart(std::size_t slots) {
  bodies_.resize(slots);
  mobility_.resize(slots);
  predicted_.resize(slots);
  counts_travels_ = false;
}

void Places::place(const Solids& solids, std::span<const std::int32_t> involved,
                   std::span<const MovingPose> bodies, double time, double motion) {
  for (std::size_t s = 0; s < bodies.size(); ++s) {
    const MovingPose& body = bodies[s];
    Placed& was = bodies_[s];
    Placed to{
        .x = body.pose.x, .axes = triad(body.pose.q), .velocity = body.velocity, .spin = body.spin};
    if (counts_travels_)
      to.travelled = was.travelled + farthest_travel(was, to, solids.radius(involved[s]));
    was = to;
    const InverseInertia inverse = solids.inverse_inertia(involved[s]);
    mobility_[s] = {inverse.mass, SymmetricMatrix::along(to.axes, inverse.moments)};
  }
  for (std::size_t k = 0; k < parts_.size(); ++k) {
    const std::int32_t index = part_index(k);
    if (solids.obstacle(index).is_carried()) continue;  // it is where its body is
    Placed& was = parts_[k];
    Placed to = place_of(solids.obstacle(index), time, motion);
    if (counts_travels_)
      to.travelled = was.travelled + farthest_travel(was, to, solids.radius(index));
    was = to;
  }
  time_ = time;
  counts_travels_ = true;
}

void Places::predict(const Solids& solids, double after,
                     std::span<const Acceleration> accelerations) {
  for (std::size_t s = 0; s < bodies_.size(); ++s) {
    predicted_[s] = {.velocity = bodies_[s].velocity + after * accelerations[s].linear,
                     .spin = bodies_[s].spin + after * accelerations[s].angular};
  }
  for (std::size_t k = 0; k < parts_.size(); ++k) {
    const ObstacleMotion& motion = solids.obstacle(part_index(k)).motion;
    predicted_parts_[k] = {.velocity = motion.rate(time_), .spin = motion.spin(time_)};
  }
}

}  // namespace floe
