/// \file
/// One leapfrog step of rigid bodies, one body per lane (model.md section 8, "Rotation of a
/// body").
///
/// Kick:  v += dt F/m, L += dt tau   (L: angular momentum in the world)
/// Drift: u += dt v, and the free rotation of a rigid body with momentum L over dt by the symmetric
/// product of rotations about its principal axes 1 2 3 2 1 by dt/2 dt/2 dt dt/2 dt/2 (each the flow
/// of l_k^2/2I_k, so symplectic and time-reversible; McLachlan 1993; Reich 1994). L stays as it is,
/// only the body turns under it. A rotation by theta enters as t = tan(theta'/2) = theta/2
/// (Cayley): theta' depends on l_k only, so the map stays symplectic and of second order, without a
/// transcendental function.
#pragma once

#include <cmath>

#include "floe/base/rotation.h"
#include "floe/base/simd.h"

namespace floe {

/// What a body resists with: inverse mass and principal moments, and its principal axes at rest.
template <class T>
struct BodyConstants {
  T inverse_mass;
  Vec3<T> inverse_inertia;
  Quat<T> axes;
};

template <class T>
struct BodyMotion {
  Vec3<T> u;
  Quat<T> q;  ///< from rest
  Vec3<T> v, w, momentum;
};

/// Angular momentum and quaternion (principal axes to world, not normalised) turned by half a step
/// about one axis.
template <int axis, class T>
void turn_about(Quat<T>& q, Vec3<T>& l, const T& inverse_inertia, double half_step) {
  const auto component = [&]() -> const T& {
    if constexpr (axis == 0) return l.x;
    if constexpr (axis == 1) return l.y;
    if constexpr (axis == 2) return l.z;
  };
  const T t = half_step * T(component() * inverse_inertia);
  const T t2 = t * t;
  const T scale = 1.0 / T(1.0 + t2);
  const T c = T(1.0 - t2) * scale, s = T(2.0 * t) * scale;
  if constexpr (axis == 0) {
    l = {l.x, T(c * l.y) + T(s * l.z), T(c * l.z) - T(s * l.y)};
    q = {q.w - T(t * q.x), q.x + T(t * q.w), q.y + T(t * q.z), q.z - T(t * q.y)};
  } else if constexpr (axis == 1) {
    l = {T(c * l.x) - T(s * l.z), l.y, T(c * l.z) + T(s * l.x)};
    q = {q.w - T(t * q.y), q.x - T(t * q.z), q.y + T(t * q.w), q.z + T(t * q.x)};
  } else {
    l = {T(c * l.x) + T(s * l.y), T(c * l.y) - T(s * l.x), l.z};
    q = {q.w - T(t * q.z), q.x + T(t * q.y), q.y - T(t * q.x), q.z + T(t * q.w)};
  }
}

template <class T>
Quat<T> unit(const Quat<T>& q) {
  using std::sqrt;
  const T n = 1.0 / sqrt(T(T(q.w * q.w) + T(q.x * q.x)) + T(T(q.y * q.y) + T(q.z * q.z)));
  return {n * q.w, n * q.x, n * q.y, n * q.z};
}

/// Turns a body freely over dt under its angular momentum; sets its angular velocity at the end.
template <class T>
void drift_rotation(const BodyConstants<T>& body, BodyMotion<T>& m, double dt) {
  Quat<T> axes = product(m.q, body.axes);
  Vec3<T> l = triad(axes).to_local(m.momentum);
  const Vec3<T>& inverse = body.inverse_inertia;
  turn_about<0>(axes, l, inverse.x, 0.25 * dt);
  turn_about<1>(axes, l, inverse.y, 0.25 * dt);
  turn_about<2>(axes, l, inverse.z, 0.5 * dt);
  turn_about<1>(axes, l, inverse.y, 0.25 * dt);
  turn_about<0>(axes, l, inverse.x, 0.25 * dt);
  axes = unit(axes);
  m.q = unit(product(axes, conjugate(body.axes)));
  m.w = triad(axes).to_world({inverse.x * l.x, inverse.y * l.y, inverse.z * l.z});
}

/// Kick and drift of a free body.
template <class T>
void leap(const BodyConstants<T>& body, BodyMotion<T>& m, const Vec3<T>& force,
          const Vec3<T>& moment, double dt) {
  m.v = m.v + T(dt * body.inverse_mass) * force;
  m.u = m.u + dt * m.v;
  m.momentum = m.momentum + dt * moment;
  drift_rotation(body, m, dt);
}

}  // namespace floe
