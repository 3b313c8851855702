/// \file
/// Half-spaces, each bounded by a plane.
#pragma once

#include "floe/base/rotation.h"

namespace floe {

/// The half-space of all points r with normal . r <= offset. The normal is a unit vector.
struct HalfSpace {
  Vec3<double> normal;
  double offset = 0;  ///< [m]
};

}  // namespace floe
