#include "floe/base/motion_table.h"

#include <cmath>

namespace floe {

double MotionTable::value(std::size_t component, double time) const {
  const auto [number, is_rate] = columns[component];
  if (number < 0) return 0;
  const auto k = static_cast<std::size_t>(number);
  return is_rate ? table.integral(k, time) : table.value(k, time);
}

double MotionTable::rate(std::size_t component, double time) const {
  const auto [number, is_rate] = columns[component];
  if (number < 0) return 0;
  const auto k = static_cast<std::size_t>(number);
  return is_rate ? table.value(k, time) : table.rate(k, time);
}

double MotionTable::acceleration(std::size_t component, double time) const {
  const auto [number, is_rate] = columns[component];
  if (number < 0) return 0;
  const auto k = static_cast<std::size_t>(number);
  return is_rate ? table.rate(k, time) : table.second(k, time);
}

double MotionTable::largest_rate(std::size_t component) const {
  const auto [number, is_rate] = columns[component];
  if (number < 0) return 0;
  const auto k = static_cast<std::size_t>(number);
  return is_rate ? table.largest(k) : table.largest_rate(k);
}

Vec3<double> MotionTable::way(double time) const {
  return {value(0, time), value(1, time), value(2, time)};
}
Vec3<double> MotionTable::velocity(double time) const {
  return {rate(0, time), rate(1, time), rate(2, time)};
}
Vec3<double> MotionTable::turn(double time) const {
  return {value(3, time), value(4, time), value(5, time)};
}
Vec3<double> MotionTable::turning(double time) const {
  return {rate(3, time), rate(4, time), rate(5, time)};
}
double MotionTable::largest_speed() const {
  return std::hypot(largest_rate(0), largest_rate(1), largest_rate(2));
}
double MotionTable::largest_turning() const {
  return std::hypot(largest_rate(3), largest_rate(4), largest_rate(5));
}

Vec3<double> spin_of(const Vec3<double>& turn, const Vec3<double>& rate) {
  const double angle2 = dot(turn, turn), angle = std::sqrt(angle2);
  constexpr double small = 1e-2;  // the next terms of the series are a^4/720 and a^4/5040
  const double first = angle < small ? 0.5 - angle2 / 24 : (1 - std::cos(angle)) / angle2;
  const double second =
      angle < small ? 1.0 / 6 - angle2 / 120 : (angle - std::sin(angle)) / (angle2 * angle);
  const Vec3<double> across = cross(turn, rate);
  return rate + first * across + second * cross(turn, across);
}

}  // namespace floe
