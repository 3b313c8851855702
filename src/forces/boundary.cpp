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

std::array<double, 6> Boundary::value(double time) const {
  std::array<double, 6> at{};
  for (std::size_t k = 0; k < 3; ++k) {
    if (fixed[k] && displacement) at[k] = ramp.value(time) * (*displacement)[k];
    if (fixed[k] && velocity) at[k] = ramp.integral(time) * (*velocity)[k];
    if (fixed[3 + k]) at[3 + k] = ramp.integral(time) * angular_velocity[k];
  }
  return at;
}

}  // namespace floe
