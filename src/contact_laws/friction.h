/// \file
/// Friction of contacts: Coulomb's, with springs between the bodies (model.md, "Contact").
#pragma once

#include <cmath>

#include "base/choices.h"
#include "floe/base/rotation.h"

namespace floe {

/// The springs of friction of a pair.
template <class T>
struct FrictionSpringsOf {
  T stiffness = 0;  ///< k_t [N/m]
  Vec3<T> force{};  ///< F_t on A [N]

  /// Returns the energy in the springs [J].
  double energy() const { return stiffness > 0 ? 0.5 * dot(force, force) / stiffness : 0.0; }
};
using FrictionSprings = FrictionSpringsOf<double>;

/// Returns the factor by which a spring is scaled down if its stiffness has fallen.
template <class T>
constexpr T fall(const T& stiffness, const T& before) {
  const auto falls = stiffness < before;
  return chosen(falls, T(stiffness / chosen(falls, before, T(1.0))), T(1.0));
}

/// Returns the force of the springs in the tangent plane of the present normal: turned into this
/// plane at equal size, and scaled down if the stiffness has fallen [N].
/// \param last       the springs after the last step
/// \param normal     of the contact, a unit vector
/// \param stiffness  present k_t [N/m]
template <class T>
constexpr Vec3<T> carried(const FrictionSpringsOf<T>& last, const Vec3<T>& normal,
                          const T& stiffness) {
  const Vec3<T>& f = last.force;
  const T before2 = dot(f, f);
  const Vec3<T> in_plane = f - dot(f, normal) * normal;
  const T size2 = dot(in_plane, in_plane);
  const auto none = before2 == 0.0 || size2 == 0.0;
  using std::sqrt;
  const T share = fall(stiffness, last.stiffness) * sqrt(T(before2 / chosen(none, T(1.0), size2)));
  return chosen(none, Vec3<T>{}, share * in_plane);
}

/// The spring of friction against a spin about the normal.
template <class T>
struct TwistSpringOf {
  T stiffness = 0;  ///< k_t tr(J2)/|S| [N m]
  T couple = 0;     ///< M_n on A, about n [N m]

  /// Returns the energy in the spring [J].
  double energy() const { return stiffness > 0 ? 0.5 * couple * couple / stiffness : 0.0; }
};
using TwistSpring = TwistSpringOf<double>;

/// Returns the couple of the spring, scaled down if the stiffness has fallen [N m].
template <class T>
constexpr T carried(const TwistSpringOf<T>& last, const T& stiffness) {
  return last.couple * fall(stiffness, last.stiffness);
}

/// Force and couple of friction.
template <class T>
struct FrictionOf {
  Vec3<T> force{};  ///< on A, normal to n [N]
  T couple = 0;     ///< on A, about n [N m]
};
using Friction = FrictionOf<double>;

/// Returns friction within its limit, which slip and spin share:
/// (|F|/(mu F_n))^2 + (M/(mu F_n r_eff))^2 <= 1, within 14 % of the exact limit of a rigid face.
/// \param most   mu F_n [N]
/// \param reach  r_eff [m]
template <class T>
constexpr FrictionOf<T> within(const FrictionOf<T>& friction, const T& most, const T& reach) {
  using std::sqrt;
  const auto none = most <= 0.0, turns = reach > 0.0;
  const T couple = chosen(turns, friction.couple, T(0.0)),
          of_spin = couple / chosen(turns, reach, T(1.0));
  const T load2 = dot(friction.force, friction.force) + of_spin * of_spin;
  const auto slides = !(load2 <= most * most);
  const T share = chosen(slides, T(most / sqrt(chosen(slides, load2, T(1.0)))), T(1.0));
  return {.force = chosen(none, Vec3<T>{}, share * friction.force),
          .couple = chosen(none, T(0.0), T(share * couple))};
}

/// Returns the force of the springs turned with the bodies about the normal, by a rotation of
/// Cayley's form, which keeps lengths. The tangent of half the angle is the start of its series,
/// which errs by 5e-8 of the angle at 0.2 rad, far more than a step's.
/// \param turn  mean angle of the bodies about the normal in the last step [rad]
template <class T>
constexpr Vec3<T> turned(const Vec3<T>& force, const Vec3<T>& normal, const T& turn) {
  const T h = 0.5 * turn, t = h * (1.0 + h * h * (1.0 / 3 + h * h * (2.0 / 15)));
  const T share = 1.0 / (1.0 + t * t);
  return share * ((1.0 - t * t) * force + (2.0 * t) * cross(normal, force));
}

}  // namespace floe
