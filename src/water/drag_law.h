/// \file
/// The drag of the water on a body (model.md, "Water"), on any scalar.
#pragma once

#include <cmath>

#include "floe/base/rotation.h"

namespace floe {

/// Force of the drag [N]: -(c + rho C_d/2 |v|) A v.
/// \tparam quadratic    whether C_d is above 0
/// \param linear       c [N s/m^3]
/// \param coefficient  rho C_d/2 [N s^2/m^4]
/// \param area         wet area [m^2]
/// \param v            velocity relative to the water [m/s]
template <bool quadratic, class T>
constexpr Vec3<T> drag_force(double linear, double coefficient, const T& area, const Vec3<T>& v) {
  using std::sqrt;
  T factor(linear);
  if constexpr (quadratic) factor += coefficient * sqrt(dot(v, v));
  const T drag = -T(factor * area);
  return drag * v;
}

}  // namespace floe
