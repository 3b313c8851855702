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

/// Returns a half-space in another frame. \param axes, x  axes and origin of its own frame there
constexpr HalfSpace placed(const HalfSpace& plane, const Triad<double>& axes,
                           const Vec3<double>& x) {
  const Vec3<double> normal = axes.to_world(plane.normal);
  return {normal, plane.offset + dot(normal, x)};
}

}  // namespace floe
