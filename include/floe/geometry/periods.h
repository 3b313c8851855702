/// \file
/// Lengths after which a model repeats itself.
#pragma once

#include <cmath>

#include "floe/base/rotation.h"

namespace floe {

/// A model that repeats itself in x, in y or in both: each body stands for itself and for its
/// images at multiples of the periods. Bodies are not moved back when they leave; their nearest
/// images meet.
struct Periods {
  Vec3<double> length{0, 0, 0};  ///< [m]; 0: the model does not repeat itself along this axis

  constexpr bool any() const { return length.x > 0 || length.y > 0; }
  /// Returns what lies between two bodies, x_A - x_B, from the nearest image of B [m].
  template <class T = double>
  constexpr Vec3<T> nearest(const Vec3<T>& apart) const {
    return {fold(apart.x, length.x), fold(apart.y, length.y), apart.z};
  }

 private:
  template <class T>
  static constexpr T fold(T x, double period) {
    return period > 0 ? x - period * std::nearbyint(x / period) : x;
  }
};

}  // namespace floe
