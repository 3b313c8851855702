/// \file
/// Bodies and obstacles at their places, and their relative motion: the text of all back ends.
#pragma once

#include "contact_laws/response.h"
#include "floe/base/rotation.h"

namespace floe {

/// Place and motion of a body or obstacle in an evaluation.
struct Placed {
  Vec3<double> x;           ///< centroid, or origin of the frame of an obstacle [m]
  Triad<double> axes;       ///< of its frame
  Vec3<double> velocity{};  ///< [m/s]
  Vec3<double> spin{};      ///< [rad/s]
  double travelled = 0;     ///< bound of the travel of its points since the last build [m]
};

/// Axes and origin of the frame of A in that of B.
struct Relative {
  Triad<double> turn;
  Vec3<double> x;

  constexpr Relative(const Placed& a, const Placed& b)
      : turn{b.axes.to_local(a.axes.e1), b.axes.to_local(a.axes.e2), b.axes.to_local(a.axes.e3)},
        x(b.axes.to_local(a.x - b.x)) {}
};

/// Velocity and spin of a body or obstacle [m/s, rad/s].
template <class T>
struct BodyVelocityOf {
  Vec3<T> velocity{}, spin{};
};
using BodyVelocity = BodyVelocityOf<double>;

/// Returns the motion of A relative to B at a point.
/// \param centre  the point, from the centroid of A [m]
/// \param apart   x_A - x_B [m]
template <class T>
constexpr RelativeMotionOf<T> relative_motion(const BodyVelocityOf<T>& a,
                                              const BodyVelocityOf<T>& b, const Vec3<T>& centre,
                                              const Vec3<T>& apart) {
  return {.velocity =
              (a.velocity + cross(a.spin, centre)) - (b.velocity + cross(b.spin, centre + apart)),
          .spin = a.spin - b.spin};
}

}  // namespace floe
