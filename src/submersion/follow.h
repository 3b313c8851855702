/// \file
/// How a submerged part changes with the place of its body, to first order (model.md, "Water"), on
/// any scalar.
#pragma once

#include "submersion/prism.h"

namespace floe {

/// Place of a body when its submerged part was found, and what was found.
template <class T>
struct Expansion {
  T z;        ///< displacement along z, over the water [m]
  Quat<T> q;  ///< rotation from rest
  T volume;   ///< [m^3]
  Vec3<T> moment;
  Waterplane<T> waterplane;
};

/// The submerged part at a later place.
template <class T>
struct Followed {
  T volume;  ///< perhaps below 0 [m^3]
  Vec3<T> moment;
  T shift, turn2;  ///< way along z since [m], square of the turn since [rad^2]
};

/// With the shift u_z and the turn t since, by Reynolds' theorem:
///   V += -int_W (u_z + t_x r_y - t_y r_x) dA,   m += t x m - int_W r (u_z + t_x r_y - t_y r_x) dA.
/// The moment along z stays as it was.
template <class T>
constexpr Followed<T> followed(const Expansion<T>& e, const T& z, const Quat<T>& q) {
  const T shift = z - e.z;
  // Twice the vector part of q q_1* = 1 + (q - q_1) q_1*: exactly 0 for a body that has not turned.
  const Quat<T> d{q.w - e.q.w, q.x - e.q.x, q.y - e.q.y, q.z - e.q.z};
  const Vec3<T> v{d.x, d.y, d.z}, v1{e.q.x, e.q.y, e.q.z};
  const Vec3<T> turn = 2.0 * (e.q.w * v - d.w * v1 + cross(v1, v));
  const Waterplane<T>& w = e.waterplane;
  const Vec3<T>& m1 = e.moment;
  return {
      T(e.volume - (w.area * shift + w.y * turn.x - w.x * turn.y)),
      {T(m1.x + T(turn.y * m1.z - turn.z * m1.y) - (w.x * shift + w.xy * turn.x - w.xx * turn.y)),
       T(m1.y + T(turn.z * m1.x - turn.x * m1.z) - (w.y * shift + w.yy * turn.x - w.xy * turn.y)),
       m1.z},
      shift,
      dot(turn, turn)};
}

}  // namespace floe
