/// \file
/// One leapfrog step of a rigid body, on any scalar (model.md, "Explicit dynamics").
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

/// Lanes take series in the squares t^2 of the half turns of a step. Where the squares of a body
/// reach this sum, about 0.02 rad per step, it is computed alone, with closed forms.
inline constexpr double small_square = 1e-4;

/// 1/(1 + x) for a small x >= 0 by its series, whose first neglected term is 1e-16.
template <class T>
constexpr T inverse_above_one(const T& x) {
  return T(1.0 - x) * T(1.0 + T(x * x));
}
constexpr double inverse_above_one(double x) {
  return x < small_square ? inverse_above_one<double>(x) : 1.0 / (1.0 + x);
}

/// 1/sqrt(1 + x) for a small x by its series, whose first neglected term is 3e-17 (Abramowitz &
/// Stegun 3.6.10).
template <class T>
constexpr T inverse_root(const T& x) {
  return T(1.0 - T(0.5 * x)) + T(T(x * x) * T(3.0 / 8.0 - T(5.0 / 16.0 * x)));
}
constexpr double inverse_root(double x) {
  return -small_square < x && x < small_square ? inverse_root<double>(x) : 1.0 / std::sqrt(1.0 + x);
}

/// Turns the angular momentum l (in principal axes) and the quaternion q (principal axes to world,
/// not normalised) about one axis.
/// \param half  half the step over the moment of inertia: t = half l, the rotation is by 2 atan t
template <int axis, class T>
constexpr void turn_about(Quat<T>& q, Vec3<T>& l, const T& half) {
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

/// |q|^2 - 1 of a quaternion whose norm differs from 1 by the rotations of one step only: of a unit
/// quaternion, the sum of their t^2 to first order, and not less.
template <class T>
constexpr T excess_of(const Quat<T>& q) {
  return T(T(T(q.w * q.w) - 1.0) + T(q.x * q.x)) + T(T(q.y * q.y) + T(q.z * q.z));
}

/// The vector that the unit quaternion (w, u) turns v to: v + 2 w u x v + 2 u x (u x v), which
/// takes half the operations of a triad where only one vector is turned.
template <class T>
constexpr Vec3<T> turned(const T& w, const Vec3<T>& u, const Vec3<T>& v) {
  const Vec3<T> across = cross(Vec3<T>{T(u.x + u.x), T(u.y + u.y), T(u.z + u.z)}, v);
  return v + w * across + cross(u, across);
}

/// Rotation and angular velocity at the end of a drift, and |q|^2 - 1 before q was normalised.
template <class T>
struct Drift {
  Quat<T> q;
  Vec3<T> w;
  T excess;
};
template <class T>
constexpr Drift<T> drift_of(const BodyConstants<T>& body, const Quat<T>& q, const Vec3<T>& momentum,
                            double dt) {
  Quat<T> axes = product(q, body.axes);
  Vec3<T> l = turned(axes.w, Vec3<T>{T(-axes.x), T(-axes.y), T(-axes.z)}, momentum);
  const Vec3<T>& inverse = body.inverse_inertia;
  const Vec3<T> half{T(T(0.25 * dt) * inverse.x), T(T(0.25 * dt) * inverse.y),
                     T(T(0.5 * dt) * inverse.z)};
  turn_about<0>(axes, l, half.x);
  turn_about<1>(axes, l, half.y);
  turn_about<2>(axes, l, half.z);
  turn_about<1>(axes, l, half.y);
  turn_about<0>(axes, l, half.x);
  const T excess = excess_of(axes), n = inverse_root(excess);
  axes = {T(n * axes.w), T(n * axes.x), T(n * axes.y), T(n * axes.z)};
  return {product(axes, conjugate(body.axes)),
          turned(axes.w, Vec3<T>{axes.x, axes.y, axes.z},
                 Vec3<T>{T(inverse.x * l.x), T(inverse.y * l.y), T(inverse.z * l.z)}),
          excess};
}

/// Turns a body freely over dt under its angular momentum and sets its angular velocity at the end.
constexpr void drift_rotation(const BodyConstants<double>& body, BodyMotion<double>& m, double dt) {
  const Drift<double> d = drift_of(body, m.q, m.momentum, dt);
  m.q = d.q;
  m.w = d.w;
}
/// Kick and drift of a free body.
template <class T>
constexpr void leap(const BodyConstants<T>& body, BodyMotion<T>& m, const Vec3<T>& force,
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
constexpr Vec3<T> leap_with_added_mass(const BodyConstants<T>& body, const Vec3<T>& mass,
                                       BodyMotion<T>& m, const Vec3<T>& force,
                                       const Vec3<T>& moment, double dt) {
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
