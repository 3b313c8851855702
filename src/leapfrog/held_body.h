/// \file
/// One leapfrog step of a body of which boundaries prescribe some components (model.md, "Explicit
/// dynamics").
#pragma once

#include <cstdint>

#include "leapfrog/rigid_body_step.h"

namespace floe {

/// What boundaries prescribe for a body over a step.
template <class T>
struct HeldBody {
  std::uint8_t bits;    ///< a bit for each of x y z rx ry rz that is prescribed
  const T *now, *next;  ///< the six values at the start and at the end of the step [m, rad]
  double dt;            ///< [s]

  constexpr bool holds(int component) const { return (bits >> component & 1) != 0; }
  constexpr T rate(int component) const { return (next[component] - now[component]) / dt; }
};

/// Corrects a step of a free body where displacements are prescribed.
/// \param before, after  motion before the step, and after it as that of a free body
/// \return the boundaries' work [J]
template <class T>
constexpr T hold_displacements(const HeldBody<T>& held, const T& inverse_mass,
                               const BodyMotion<T>& before, BodyMotion<T>& after) {
  T work = 0;
  for (int k = 0; k < 3; ++k) {
    if (!held.holds(k)) continue;
    const auto c = static_cast<std::size_t>(k);
    const T given = held.rate(k);
    work += (1.0 / inverse_mass) * (given - after.v[c]) * 0.5 * (given + before.v[c]);
    after.v[c] = given;
    after.u[c] = before.u[c] + held.dt * given;
  }
  return work;
}

/// Corrects the rotation of a step where rotations are prescribed. The boundaries give impulses
/// about the prescribed axes, which make the spin after the kick what is prescribed there.
/// \param moment  on the body [N m]
/// \return the boundaries' work [J]
template <class T>
constexpr T hold_rotations(const HeldBody<T>& held, const BodyConstants<T>& body,
                           const BodyMotion<T>& before, const Vec3<T>& moment,
                           BodyMotion<T>& after) {
  BodyMotion<T> m = before;
  m.momentum = m.momentum + held.dt * moment;
  const Triad<T> axes = triad(product(m.q, body.axes));
  const Vec3<T>& inverse = body.inverse_inertia;
  const auto spin_of = [&](const Vec3<T>& momentum) {
    const Vec3<T> l = axes.to_local(momentum);
    return axes.to_world({inverse.x * l.x, inverse.y * l.y, inverse.z * l.z});
  };
  // Impulses about the held axes, 0 about the others: columns of the system by their unknown.
  Vec3<T> columns[3] = {spin_of({1, 0, 0}), spin_of({0, 1, 0}), spin_of({0, 0, 1})};  // NOLINT
  const Vec3<T> spin = spin_of(m.momentum);
  Vec3<T> miss{0, 0, 0}, mean{0, 0, 0};
  for (int r = 0; r < 3; ++r) {
    const auto row = static_cast<std::size_t>(r);
    for (int s = 0; s < 3; ++s) {
      if (!held.holds(3 + r) || !held.holds(3 + s)) columns[s][row] = r == s ? 1 : 0;
    }
    if (!held.holds(3 + r)) continue;
    const T given = held.rate(3 + r);
    miss[row] = given - spin[row];
    mean[row] = 0.5 * (given + before.w[row]);
  }
  // Cramer's rule.
  const Vec3<T> second = cross(columns[1], columns[2]);
  const T determinant = dot(columns[0], second);
  const Vec3<T> impulse{dot(miss, second) / determinant,
                        dot(columns[0], cross(miss, columns[2])) / determinant,
                        dot(columns[0], cross(columns[1], miss)) / determinant};
  m.momentum = m.momentum + impulse;
  if (held.bits >> 3 == 7) {  // the rotation is prescribed completely: no gyroscopic motion
    m.w = {held.rate(3), held.rate(4), held.rate(5)};
    m.q = normalised(product(exp_rotation(held.dt * m.w), m.q));
    const Triad<T> turned_axes = triad(product(m.q, body.axes));
    const Vec3<T> w = turned_axes.to_local(m.w);
    m.momentum = turned_axes.to_world({w.x / inverse.x, w.y / inverse.y, w.z / inverse.z});
  } else {
    drift_rotation(body, m, held.dt);
  }
  after.q = m.q;
  after.w = m.w;
  after.momentum = m.momentum;
  return dot(impulse, mean);
}

}  // namespace floe
