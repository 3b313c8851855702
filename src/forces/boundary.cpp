#include "floe/forces/boundary.h"

#include <algorithm>

namespace floe {

double Ramp::value(double time) const {
  return time >= seconds ? 1.0 : std::max(0.0, time) / seconds;
}

double Ramp::integral(double time) const {
  if (time <= 0) return 0;
  return time >= seconds ? time - 0.5 * seconds : 0.5 * time * time / seconds;
}

double Ramp::slope(double time) const { return time >= 0 && time < seconds ? 1.0 / seconds : 0.0; }

namespace {

/// \param moved, moving  factors of what is given as a displacement and as a velocity
std::array<double, 6> motion(const Boundary& b, double moved, double moving) {
  std::array<double, 6> at{};
  for (std::size_t k = 0; k < 3; ++k) {
    if (b.fixed[k] && b.displacement) at[k] = moved * (*b.displacement)[k];
    if (b.fixed[k] && b.velocity) at[k] = moving * (*b.velocity)[k];
    if (b.fixed[3 + k]) at[3 + k] = moving * b.angular_velocity[k];
  }
  return at;
}

}  // namespace

std::array<double, 6> Boundary::value(double time) const {
  return motion(*this, ramp.value(time), ramp.integral(time));
}

std::array<double, 6> Boundary::rate(double time) const {
  return motion(*this, ramp.slope(time), ramp.value(time));
}

std::array<double, 6> Boundary::acceleration(double time) const {
  return motion(*this, 0, ramp.slope(time));
}

}  // namespace floe
