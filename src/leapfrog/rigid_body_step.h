/// \file
/// One leapfrog step of rigid bodies, one body per lane (model.md, "Explicit dynamics").
///
/// Kick:  v += dt F/m, L += dt tau   (L: angular momentum in the world)
/// Drift: u += dt v, and the free rotation of a rigid body with angular momentum L over dt, by the
/// symmetric product of rotations about its principal axes 1 2 3 2 1 by dt/2 dt/2 dt dt/2 dt/2
/// (each the flow of l_k^2/2I_k, so symplectic and time-reversible; McLachlan 1993; Reich 1994). L
/// does not change in the drift; the body turns under it. A rotation by theta enters as t =
/// tan(theta'/2) = theta/2 (Cayley): theta' depends on l_k only, so the map stays symplectic and of
/// second order, without a transcendental function.
#pragma once

#include <cmath>

#include "base/simd.h"
#include "floe/base/rotation.h"

namespace floe {

/// Inverse mass and inverse principal moments of inertia of a body, and its principal axes at rest.
template <class T>
struct BodyConstants {
  T inverse_mass;
  Vec3<T> inverse_inertia;
  Quat<T> axes;
};

/// Motion of a body: displacement, rotation, velocity, angular velocity, angular momentum.
template <class T>
struct BodyMotion {
  Vec3<T> u;
  Quat<T> q;  ///< rotation from rest
  Vec3<T> v, w, momentum;
};

/// 1/(1 + x) for a small x >= 0 by its series, whose first neglected term is 1e-16. A body that
/// turns by more than 0.04 rad per step needs the division. The results of other bodies in the
/// lanes must not depend on whether one of them needs it.
inline constexpr double small_square = 1e-4;
template <class T>
T inverse_above_one_series(const T& x) {
  return T(1.0 - x) * T(1.0 + T(x * x));
}
inline double inverse_above_one(double x) {
  return x < small_square ? inverse_above_one_series(x) : 1.0 / (1.0 + x);
}
inline Lanes inverse_above_one(const Lanes& x) {
  Lanes value = inverse_above_one_series(x);
  const auto large = !(x < small_square);
  if (any_of(large)) [[unlikely]]
    where(large, value) = 1.0 / (1.0 + x);
  return value;
}

/// 1/sqrt(1 + x) for a small x by its series, as above; the first neglected term is 0.2 x^6
/// (Abramowitz & Stegun 3.6.10).
inline constexpr double small_excess = 1e-3;
template <class T>
T inverse_root_series(const T& x) {
  const T x2 = x * x;
  const T low = T(1.0 - T(0.5 * x)), middle = T(3.0 / 8.0 - T(5.0 / 16.0 * x)),
          high = T(35.0 / 128.0 - T(63.0 / 256.0 * x));
  return low + T(x2 * T(middle + T(x2 * high)));
}
inline double inverse_root(double x) {
  return std::abs(x) < small_excess ? inverse_root_series(x) : 1.0 / std::sqrt(1.0 + x);
}
inline Lanes inverse_root(const Lanes& x) {
  Lanes value = inverse_root_series(x);
  const auto large = !(abs(x) < small_excess);
  if (any_of(large)) [[unlikely]]
    where(large, value) = 1.0 / sqrt(1.0 + x);
  return value;
}

/// Turns the angular momentum l (in principal axes) and the quaternion q (principal axes to world,
/// not normalised) about one axis.
/// \param half  half the step over the moment of inertia: t = half l, the rotation is by 2 atan t
template <int axis, class T>
void turn_about(Quat<T>& q, Vec3<T>& l, const T& half) {
  // sin = 2 t/(1 + t^2), cos = 1 - t sin
  const auto turn = [&](const T& t, T& first, T& second) {
    const T s = T(t + t) * inverse_above_one(T(t * t));
    const T was = first;
    first = was + T(s * T(second - T(t * was)));
    second = second - T(s * T(was + T(t * second)));
  };
  if constexpr (axis == 0) {
    const T t = half * l.x;
    turn(t, l.y, l.z);
    q = {q.w - T(t * q.x), q.x + T(t * q.w), q.y + T(t * q.z), q.z - T(t * q.y)};
  } else if constexpr (axis == 1) {
    const T t = half * l.y;
    turn(t, l.z, l.x);
    q = {q.w - T(t * q.y), q.x - T(t * q.z), q.y + T(t * q.w), q.z + T(t * q.x)};
  } else {
    const T t = half * l.z;
    turn(t, l.x, l.y);
    q = {q.w - T(t * q.z), q.x + T(t * q.y), q.y - T(t * q.x), q.z + T(t * q.w)};
  }
}

/// Normalises a quaternion whose norm differs from 1 by the rotations of one step only.
template <class T>
Quat<T> unit(const Quat<T>& q) {
  const T n =
      inverse_root(T(T(T(q.w * q.w) - 1.0) + T(q.x * q.x)) + T(T(q.y * q.y) + T(q.z * q.z)));
  return {n * q.w, n * q.x, n * q.y, n * q.z};
}

/// Turns a body freely over dt under its angular momentum and sets its angular velocity at the end.
template <class T>
void drift_rotation(const BodyConstants<T>& body, BodyMotion<T>& m, double dt) {
  Quat<T> axes = product(m.q, body.axes);
  Vec3<T> l = triad(axes).to_local(m.momentum);
  const Vec3<T>& inverse = body.inverse_inertia;
  const Vec3<T> half{T(T(0.25 * dt) * inverse.x), T(T(0.25 * dt) * inverse.y),
                     T(T(0.5 * dt) * inverse.z)};
  turn_about<0>(axes, l, half.x);
  turn_about<1>(axes, l, half.y);
  turn_about<2>(axes, l, half.z);
  turn_about<1>(axes, l, half.y);
  turn_about<0>(axes, l, half.x);
  axes = unit(axes);
  m.q = product(axes, conjugate(body.axes));
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

/// Kick and drift of a free body whose mass differs between its principal axes, as that of a body
/// with added mass does (Kirchhoff's equations; Lamb 1932, chapter VI): with R its principal
/// axes and M its masses along them, p = R M R^T v,
///
///   dp/dt = F,  dL/dt = tau - v x p  (the moment of Munk 1924).
///
/// The drift is the symmetric product of the flow of p.M^-1 p/2 at fixed R over dt/2, the free
/// rotation over dt, and the former over dt/2: symplectic and time-reversible. Velocities are
/// stored with the axes at the end of the drift, as the angular velocity is.
///
/// \param mass  along the principal axes
/// \returns the velocity after the kick, with the axes before the drift: forces work with it
template <class T>
Vec3<T> leap_with_added_mass(const BodyConstants<T>& body, const Vec3<T>& mass, BodyMotion<T>& m,
                             const Vec3<T>& force, const Vec3<T>& moment, double dt) {
  const Vec3<T> inverse{T(1.0 / mass.x), T(1.0 / mass.y), T(1.0 / mass.z)};
  const auto along = [](const Triad<T>& axes, const Vec3<T>& factors, const Vec3<T>& v) {
    const Vec3<T> l = axes.to_local(v);
    return axes.to_world({T(factors.x * l.x), T(factors.y * l.y), T(factors.z * l.z)});
  };
  const double half = 0.5 * dt;
  const Triad<T> before = triad(product(m.q, body.axes));
  const Vec3<T> p = along(before, mass, m.v) + dt * force;
  const Vec3<T> first = along(before, inverse, p);
  m.u = m.u + half * first;
  m.momentum = m.momentum + dt * moment - half * cross(first, p);
  drift_rotation(body, m, dt);
  const Triad<T> after = triad(product(m.q, body.axes));
  m.v = along(after, inverse, p);
  m.u = m.u + half * m.v;
  m.momentum = m.momentum - half * cross(m.v, p);
  m.w = along(after, body.inverse_inertia, m.momentum);
  return first;
}

}  // namespace floe
