/// \file
/// The wrench of a support on a body: springs and dashpots at a point of it. This text is that of
/// every back end.
#pragma once

#include <cmath>

#include "floe/base/rotation.h"

namespace floe {

/// Force and moment [N, N m], or what they act on.
template <class T>
struct SupportWrenchOf {
  Vec3<T> force, moment;
};

/// The product of a matrix of a support, row by row, and (a, b), in two parts.
template <class Matrix, class T>
constexpr SupportWrenchOf<T> product_of(const Matrix& m, const Vec3<T>& a, const Vec3<T>& b) {
  const auto row = [&](int r) {
    T sum = 0;
    for (int k = 0; k < 3; ++k) {
      const auto n = static_cast<std::size_t>(6 * r + k), c = static_cast<std::size_t>(k);
      sum += m[n] * a[c] + m[n + 3] * b[c];
    }
    return sum;
  };
  return {{row(0), row(1), row(2)}, {row(3), row(4), row(5)}};
}

/// 1/t^2 - (1 + cos t)/(2 t sin t); its series where t is small: both terms are large there.
template <class T>
constexpr T turning_curvature(const T& t) {
  using std::cos;
  using std::sin;
  constexpr double small = 0.05;
  const T t2 = t * t;
  if (t < small) return 1.0 / 12 + t2 / 720 + t2 * t2 / 30240;
  return 1 / t2 - (1 + cos(t)) / (2 * t * sin(t));
}

/// Wrench of springs about their point. In axes of the world at rest displacement d of the point
/// and rotation vector t of the body have the potential U = (d, t) K (d, t) / 2. The force is
/// -dU/dd. Since dt/dtime = J^-1(t) w with the left Jacobian J of rotations, the moment is
/// -J^-T(t) dU/dt with
///   J^-T = I + [t]/2 + (1/t^2 - (1 + cos t)/(2 t sin t)) [t]^2
/// (Sola, Deray & Atchuthan 2018, eq. 146), [t] the cross product by t.
template <class Matrix, class T>
constexpr SupportWrenchOf<T> springs_of(const Matrix& stiffness, const Vec3<T>& shift,
                                        const Vec3<T>& turn) {
  const auto [force, g] = product_of(stiffness, shift, turn);
  const Vec3<T> once = cross(turn, g);
  const Vec3<T> moment = g + 0.5 * once + turning_curvature(length(turn)) * cross(turn, once);
  return {-force, -moment};
}

/// What a support does to a body.
template <class T>
struct SupportedBody {
  Vec3<T> shift, turn;         ///< of its point [m], of the body [rad]
  SupportWrenchOf<T> wrench;   ///< about the point
  Vec3<T> moment;              ///< of the force and moment about the centroid [N m]
  SupportWrenchOf<T> damping;  ///< of the dashpots alone, about the centroid
};

/// \param rest     arm from the centroid to the point, at rest [m]
/// \param u, q     displacement and rotation \param v, w  velocity and spin
template <class Matrix, class T>
constexpr SupportedBody<T> supported(const Matrix& stiffness, const Matrix& damping,
                                     const Vec3<T>& rest, const Vec3<T>& u, const Quat<T>& q,
                                     const Vec3<T>& v, const Vec3<T>& w) {
  SupportedBody<T> s;
  const Vec3<T> arm = rotate(q, rest);
  s.shift = u + (arm - rest);
  s.turn = log_rotation(q);
  const SupportWrenchOf<T> spring = springs_of(stiffness, s.shift, s.turn);
  const auto [force, moment] = product_of(damping, v + cross(w, arm), w);
  s.damping = {-force, -moment + cross(arm, -force)};
  s.wrench = {spring.force - force, spring.moment - moment};
  s.moment = s.wrench.moment + cross(arm, s.wrench.force);
  return s;
}

}  // namespace floe
