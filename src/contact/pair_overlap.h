/// \file
/// Overlaps of pairs in the world: the text of all back ends.
#pragma once

#include "contact/placed.h"
#include "floe/geometry/half_space.h"
#include "geometry/overlap.h"

namespace floe {

/// Gaps below this part of the radius of a body, and overlaps below this part of its cube, are
/// rounding.
inline constexpr double rounding_of_gaps = 1e-13, rounding_of_volumes = 1e-15;

/// The overlap of a pair, in world axes from the centroid of A; no overlap: volume 0.
template <class T>
struct PairOverlapOf {
  OverlapOf<T> overlap;
  T depth = 0;  ///< of the centroid of the overlap below the first face of B [m]
};
using PairOverlap = PairOverlapOf<double>;

/// Takes an overlap from the frame of B to the world; one that is rounding becomes none.
/// \param face    the first one of B
/// \param radius  of A [m]
template <class T>
constexpr void take_to_world(PairOverlapOf<T>& met, const HalfSpace& face, double radius,
                             const Placed& a, const Placed& b, bool with_patch) {
  OverlapOf<T>& o = met.overlap;
  if (o.volume <= rounding_of_volumes * radius * radius * radius) {
    o.volume = 0;
    return;
  }
  const Vec3<T> origin = b.x - a.x;
  met.depth = face.offset - dot(face.normal, o.centroid);
  o.centroid = b.axes.to_world(o.centroid) + origin;
  o.area = b.axes.to_world(o.area);
  o.moment = b.axes.to_world(o.moment);
  if (!with_patch) return;
  o.patch.middle = b.axes.to_world(o.patch.middle) + origin;
  o.patch.u = b.axes.to_world(o.patch.u);
  o.patch.v = b.axes.to_world(o.patch.v);
}

}  // namespace floe
