#include "floe/forces/boundary.h"

namespace floe {

namespace {

/// Components of a boundary.
/// \param moved, moving  factors of its `displacement`, and of its velocities
std::array<double, 6> motion(const Boundary& b, double moved, double moving) {
  std::array<double, 6> at{};
  for (std::size_t k = 0; k < 3; ++k) {
    if (b.fixed[k] && b.displacement) at[k] = moved * (*b.displacement)[k];
    if (b.fixed[k] && b.velocity) at[k] = moving * (*b.velocity)[k];
    if (b.fixed[3 + k]) at[3 + k] = moving * b.angular_velocity[k];
  }
  return at;
}

/// Components that a table says.
using Component = double (MotionTable::*)(std::size_t, double) const;
std::array<double, 6> in_table(const Boundary& b, Component component, double time) {
  std::array<double, 6> at{};
  for (std::size_t k = 0; k < at.size(); ++k)
    if (b.fixed[k]) at[k] = (b.table.*component)(k, time);
  return at;
}

}  // namespace

std::array<double, 6> Boundary::value(double time) const {
  if (!table.empty()) return in_table(*this, &MotionTable::value, time);
  return motion(*this, ramp.value(time), ramp.integral(time));
}

std::array<double, 6> Boundary::rate(double time) const {
  if (!table.empty()) return in_table(*this, &MotionTable::rate, time);
  return motion(*this, ramp.slope(time), ramp.value(time));
}

std::array<double, 6> Boundary::acceleration(double time) const {
  if (!table.empty()) return in_table(*this, &MotionTable::acceleration, time);
  return motion(*this, 0, ramp.slope(time));
}

}  // namespace floe
