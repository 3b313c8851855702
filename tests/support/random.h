// Random numbers, vectors and rotations that are the same on every machine and rank.
#pragma once

#include <cmath>
#include <cstdint>
#include <random>

#include "floe/base/rotation.h"

namespace floe::test {

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}

  double uniform(double low, double high) {
    return low + (high - low) * (static_cast<double>(engine_() >> 11) * 0x1p-53);
  }
  /// Each component between -size and size.
  Vec3<double> vector(double size) {
    const double x = uniform(-size, size), y = uniform(-size, size);
    return {x, y, uniform(-size, size)};
  }
  Vec3<double> direction() {
    for (;;) {
      const Vec3<double> v = vector(1);
      const double length = std::sqrt(dot(v, v));
      if (length > 0.1 && length < 1) return (1 / length) * v;
    }
  }
  /// By exactly `angle` about a random axis.
  Quat<double> rotation(double angle) { return exp_rotation(angle * direction()); }

 private:
  std::mt19937_64 engine_;
};

}  // namespace floe::test
