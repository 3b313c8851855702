#include "floe/contact/obstacle_motion.h"

#include <cmath>
#include <numbers>

namespace floe {
namespace {

bool is_zero(const Vec3<double>& v) { return v == Vec3<double>{}; }

}  // namespace

// Most obstacles rest or move steadily, so sines and cosines are computed only if needed.

Vec3<double> ObstacleMotion::way(double time) const {
  if (driven) return driven->at(time).way;
  if (!table.empty()) return table.way(time);
  const Vec3<double> steady = ramp.integral(time) * velocity;
  if (is_zero(amplitude)) return steady;
  const double phase = 2 * std::numbers::pi * frequency * time;
  return steady + (ramp.value(time) * std::sin(phase)) * amplitude;
}

Vec3<double> ObstacleMotion::rate(double time) const {
  if (driven) return driven->at(time).rate;
  if (!table.empty()) return table.velocity(time);
  const Vec3<double> steady = ramp.value(time) * velocity;
  if (is_zero(amplitude)) return steady;
  const double circular = 2 * std::numbers::pi * frequency, phase = circular * time;
  return steady +
         (ramp.value(time) * circular * std::cos(phase) + ramp.slope(time) * std::sin(phase)) *
             amplitude;
}

Quat<double> ObstacleMotion::turn(double time) const {
  if (driven) return driven->at(time).turn;
  if (!table.empty()) return exp_rotation(table.turn(time));
  if (is_zero(angular_velocity)) return {1, 0, 0, 0};
  return exp_rotation(ramp.integral(time) * angular_velocity);
}

Vec3<double> ObstacleMotion::spin(double time) const {
  if (driven) return driven->at(time).spin;
  if (!table.empty()) return spin_of(table.turn(time), table.turning(time));
  return ramp.value(time) * angular_velocity;
}

bool ObstacleMotion::at_rest() const {
  return !is_driven && table.empty() && is_zero(velocity) && is_zero(angular_velocity) &&
         is_zero(amplitude);
}

double ObstacleMotion::largest_speed(double radius) const {
  if (driven) return driven->largest_speed(radius);
  if (!table.empty()) {
    const double turning = table.largest_turning();
    return table.largest_speed() + (turning > 0 ? radius * turning : 0.0);
  }
  // While the amplitude rises, sin(2 pi f t)/t <= 2 pi f: the rise at most doubles the speed.
  const double rising = ramp.seconds > 0 ? 2 : 1;
  return length(velocity) + rising * 2 * std::numbers::pi * frequency * length(amplitude) +
         (is_zero(angular_velocity) ? 0.0 : radius * length(angular_velocity));
}

}  // namespace floe
