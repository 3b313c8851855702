/// \file
/// A contact as results show it.
#pragma once

#include <cstdint>

#include "floe/base/rotation.h"

namespace floe {

/// A contact between two bodies, or between a body and an obstacle.
struct ContactOfPair {
  std::int32_t a = 0;          ///< index of a body
  std::int32_t b = -1;         ///< index of the other body; -1: an obstacle that no body carries
  std::int32_t obstacle = -1;  ///< number of the obstacle; -1: none
  Vec3<double> force{};        ///< on A [N]
  Vec3<double> point{};        ///< centroid of the overlap [m]
  Vec3<double> normal{};       ///< from B to A
  double volume = 0;           ///< of the overlap [m^3]
  double area = 0;             ///< of the contact |S| [m^2]
};

}  // namespace floe
