/// \file
/// What a plane bounds.
#pragma once

#include "floe/base/rotation.h"

namespace floe {

/// A half-space: r with normal . r <= offset. The normal is a unit vector.
struct HalfSpace {
  Vec3<double> normal;
  double offset = 0;  ///< [m]
};

}  // namespace floe
