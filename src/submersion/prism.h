/// \file
/// The submerged part of a prism of which the water cuts only the sides (model.md, "Water"), on any
/// scalar.
///
/// Notation: (x, y, c) are the principal axes of a body with the origin at its centroid. R takes
/// them to the world, and (s_x, s_y) = (R_31, R_32)/R_33 is the slope of the plan. The plan of a
/// prism along c has the area A and the moments S, I about the origin. The water surface is at
/// c_w(x, y) = c_0 - s_x x - s_y y, c_0 = -z(centroid)/R_33. While the water cuts only the sides,
/// all integrals of c from the bottom to c_w are polynomials of A, S and I.
#pragma once

#include <cmath>
#include <cstddef>
#include <limits>

#include "floe/base/rotation.h"

namespace floe {

/// A body at rest, and its plan if the body is a prism along axis 3. Other bodies get an infinite
/// circumradius, so that sides_only() is false for them.
template <class T>
struct Prism {
  Quat<T> axes;              ///< principal axes
  T z;                       ///< height of the centroid [m]
  T bottom, top;             ///< end faces on axis 3 [m]
  T area, x, y, xx, xy, yy;  ///< A, S and I of the plan [m^2, m^3, m^4]
  T radius2;                 ///< square of the circumradius about axis 3 [m^2]
  static constexpr std::size_t numbers = 14;
};

constexpr bool is_prism(const Prism<double>& b) {
  return b.radius2 < std::numeric_limits<double>::infinity();
}

/// The submerged part of a prism of which the water cuts only the sides.
template <class T>
struct PrismBelow {
  Triad<T> axes;          ///< principal axes in the world
  T upright, sx, sy, c0;  ///< 1/R_33; slopes; c_0, the water over the centroid along axis 3 [m]
  T volume;               ///< [m^3]
  Vec3<T> moment;         ///< int r dV, world axes about the centroid [m^4]
};

/// Submerged part of a prism if the water cuts only the sides (else the result has no meaning).
/// \param rotation  from rest, of unit length
/// \param z         height of the centroid over the water [m]
template <class T>
constexpr PrismBelow<T> prism_below(const Prism<T>& b, const Quat<T>& rotation, const T& z) {
  PrismBelow<T> p;
  p.axes = triad(product(rotation, b.axes));
  p.upright = 1.0 / p.axes.e3.z;
  p.sx = p.axes.e1.z * p.upright;
  p.sy = p.axes.e2.z * p.upright;
  p.c0 = -(z * p.upright);
  const T depth = p.c0 - b.bottom;
  const T along = p.sx * b.x + p.sy * b.y;
  const T tilt_x = p.sx * b.xx + p.sy * b.xy, tilt_y = p.sx * b.xy + p.sy * b.yy;
  p.volume = b.area * depth - along;
  p.moment = p.axes.to_world(
      {T(depth * b.x - tilt_x), T(depth * b.y - tilt_y),
       T(0.5 * T(depth * T(T(p.c0 + b.bottom) * b.area) + T(p.sx * tilt_x + p.sy * tilt_y)) -
         p.c0 * along)});
  return p;
}

/// The waterplane of a body: its area [m^2], and its moments about the body's centroid [m^3, m^4].
template <class T>
struct Waterplane {
  T area, x, y, xx, xy, yy;
};

/// Waterplane of a prism of which the water cuts only the sides.
template <class T>
constexpr Waterplane<T> waterplane_of(const Prism<T>& b, const PrismBelow<T>& p) {
  const auto& [e1, e2, e3] = p.axes;
  // The point of the waterplane at (x, y) of the plan has the world coordinates p0 + p1 x + p2 y,
  // q0 + q1 x + q2 y from the centroid.
  const T p0 = e3.x * p.c0, p1 = e1.x - e3.x * p.sx, p2 = e2.x - e3.x * p.sy;
  const T q0 = e3.y * p.c0, q1 = e1.y - e3.y * p.sx, q2 = e2.y - e3.y * p.sy;
  const T px = p1 * b.x + p2 * b.y, qx = q1 * b.x + q2 * b.y;
  return {T(p.upright * b.area),
          T(p.upright * (p0 * b.area + px)),
          T(p.upright * (q0 * b.area + qx)),
          T(p.upright * (p0 * (p0 * b.area + 2.0 * px) + p1 * (p1 * b.xx + p2 * b.xy) +
                         p2 * (p1 * b.xy + p2 * b.yy))),
          T(p.upright * (p0 * (q0 * b.area + qx) + q0 * px + p1 * (q1 * b.xx + q2 * b.xy) +
                         p2 * (q1 * b.xy + q2 * b.yy))),
          T(p.upright * (q0 * (q0 * b.area + 2.0 * qx) + q1 * (q1 * b.xx + q2 * b.xy) +
                         q2 * (q1 * b.xy + q2 * b.yy)))};
}

/// Whether the water cuts only the sides of a prism.
/// \param axes  principal axes in the world
/// \param z     height of the centroid over the water [m]
template <class T>
constexpr auto sides_only(const Prism<T>& b, const Triad<T>& axes, const T& z) {
  // Heights over the water of the points where axis 3 meets the end faces. The heights of the
  // corners differ from these by at most sqrt(reach2).
  const T bottom = z + axes.e3.z * b.bottom, top = z + axes.e3.z * b.top;
  const T reach2 = b.radius2 * T(axes.e1.z * axes.e1.z + axes.e2.z * axes.e2.z);
  return axes.e3.z > 0.0 && bottom < 0.0 && top > 0.0 && bottom * bottom > reach2 &&
         top * top > reach2;
}

/// A quaternion scaled to unit length. A linearised quaternion (1, theta/2) is longer than 1 and
/// would enlarge the body.
template <class T>
constexpr Quat<T> of_unit_length(const Quat<T>& q) {
  using std::sqrt;
  const T n = 1.0 / sqrt(T(T(q.w * q.w) + T(q.x * q.x)) + T(T(q.y * q.y) + T(q.z * q.z)));
  return {n * q.w, n * q.x, n * q.y, n * q.z};
}

}  // namespace floe
