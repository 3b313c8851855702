#include "floe/base/driven_motion.h"

#include <cmath>

#include "floe/base/motion_table.h"

namespace floe {
namespace {

bool is_zero(const Vec3<double>& v) { return v == Vec3<double>{}; }

/// Values and rates of the cubic with a value and a rate at both ends of [0, length].
struct Cubic {
  Vec3<double> value, rate;
};
Cubic cubic(double time, double length, const Vec3<double>& a, const Vec3<double>& a_rate,
            const Vec3<double>& b, const Vec3<double>& b_rate) {
  const double s = time / length, s2 = s * s, s3 = s2 * s;
  return {.value = a + (3 * s2 - 2 * s3) * (b - a) + (length * (s - 2 * s2 + s3)) * a_rate +
                   (length * (s3 - s2)) * b_rate,
          .rate = (6 * (s - s2) / length) * (b - a) + (1 - 4 * s + 3 * s2) * a_rate +
                  (3 * s2 - 2 * s) * b_rate};
}

/// Rate of the rotation vector r with which exp([r]x) turns with a spin: the inverse of spin_of().
Vec3<double> rate_of_turn(const Vec3<double>& turn, const Vec3<double>& spin) {
  const double angle = length(turn);
  constexpr double small = 1e-3;  // the next term of the series is a^2/720
  const double factor =
      angle < small ? 1.0 / 12 : (1 - 0.5 * angle / std::tan(0.5 * angle)) / (angle * angle);
  const Vec3<double> across = cross(turn, spin);
  return spin - 0.5 * across + factor * cross(turn, across);
}

DrivenMotion::Place went_on(const DrivenMotion::Place& from, double time) {
  DrivenMotion::Place place = from;
  place.way = from.way + time * from.rate;
  if (!is_zero(from.spin)) place.turn = product(exp_rotation(time * from.spin), from.turn);
  return place;
}

/// Rotation vector from the start to the end.
Vec3<double> turn_between(const DrivenMotion& motion) {
  return log_rotation(normalised(product(motion.end.turn, conjugate(motion.start.turn))));
}

}  // namespace

DrivenMotion::Place DrivenMotion::at(double time) const {
  if (time >= until || !(until > from)) return went_on(end, time - until);
  if (time < from) return went_on(start, time - from);
  const double now = time - from, whole = until - from;
  const Cubic way = cubic(now, whole, start.way, start.rate, end.way, end.rate);
  Place place{.way = way.value, .turn = start.turn, .rate = way.rate, .spin = {}};
  const Vec3<double> apart = turn_between(*this);
  if (is_zero(apart) && is_zero(start.spin) && is_zero(end.spin)) return place;
  const Cubic turn = cubic(now, whole, {}, start.spin, apart, rate_of_turn(apart, end.spin));
  place.turn = normalised(product(exp_rotation(turn.value), start.turn));
  place.spin = spin_of(turn.value, turn.rate);
  return place;
}

double DrivenMotion::largest_speed(double radius) const {
  const double end_spin = length(end.spin);
  double speed = length(end.rate), spin = end_spin;
  if (until > from) {  // the cubic's rate: |6 (s - s^2)| <= 3/2, the other factors <= 1
    const Vec3<double> apart = turn_between(*this);
    speed += 1.5 * length(end.way - start.way) / (until - from) + length(start.rate);
    spin += 1.5 * length(apart) / (until - from) + length(start.spin) +
            length(rate_of_turn(apart, end.spin)) - end_spin;
  }
  return speed + (spin > 0 ? radius * spin : 0.0);
}

}  // namespace floe
