/// \file
/// Friction of contacts: Coulomb's, with springs between the bodies (model.md, "Contact").
#pragma once

#include <cmath>

#include "floe/base/rotation.h"

namespace floe {

/// The springs of friction of a pair.
struct FrictionSprings {
  double stiffness = 0;  ///< k_t [N/m]
  Vec3<double> force{};  ///< F_t on A [N]

  /// Returns the energy in the springs [J].
  double energy() const { return stiffness > 0 ? 0.5 * dot(force, force) / stiffness : 0.0; }
};

/// Returns the force of the springs in the tangent plane of the present normal: turned into this
/// plane at equal size, and scaled down if the stiffness has fallen [N].
/// \param last       the springs after the last step
/// \param normal     of the contact, a unit vector
/// \param stiffness  present k_t [N/m]
inline Vec3<double> carried(const FrictionSprings& last, const Vec3<double>& normal,
                            double stiffness) {
  const Vec3<double>& f = last.force;
  const double before2 = dot(f, f);
  if (before2 == 0) return {};
  const Vec3<double> in_plane = f - dot(f, normal) * normal;
  const double size2 = dot(in_plane, in_plane);
  if (size2 == 0) return {};
  const double falls = stiffness < last.stiffness ? stiffness / last.stiffness : 1.0;
  return (falls * std::sqrt(before2 / size2)) * in_plane;
}

/// The spring of friction against a spin about the normal.
struct TwistSpring {
  double stiffness = 0;  ///< k_t tr(J2)/|S| [N m]
  double couple = 0;     ///< M_n on A, about n [N m]

  /// Returns the energy in the spring [J].
  double energy() const { return stiffness > 0 ? 0.5 * couple * couple / stiffness : 0.0; }
};

/// Returns the couple of the spring, scaled down if the stiffness has fallen [N m].
inline double carried(const TwistSpring& last, double stiffness) {
  return last.stiffness > stiffness ? last.couple * (stiffness / last.stiffness) : last.couple;
}

/// Force and couple of friction.
struct Friction {
  Vec3<double> force{};  ///< on A, normal to n [N]
  double couple = 0;     ///< on A, about n [N m]
};

/// Returns friction within its limit, which slip and spin share:
/// (|F|/(mu F_n))^2 + (M/(mu F_n r_eff))^2 <= 1, within 14 % of the exact limit of a rigid face.
/// \param most   mu F_n [N]
/// \param reach  r_eff [m]
inline Friction within(const Friction& friction, double most, double reach) {
  if (most <= 0) return {};
  Friction cut = friction;
  if (reach <= 0) cut.couple = 0;
  const double of_spin = reach > 0 ? cut.couple / reach : 0.0;
  const double load2 = dot(cut.force, cut.force) + of_spin * of_spin;
  if (load2 <= most * most) return cut;
  const double share = most / std::sqrt(load2);
  return {.force = share * cut.force, .couple = share * cut.couple};
}

/// Returns the force of the springs turned with the bodies about the normal, by a rotation of
/// Cayley's form, which keeps lengths. The tangent of half the angle is the start of its series,
/// which errs by 5e-8 of the angle at 0.2 rad, far more than a step's.
/// \param turn  mean angle of the bodies about the normal in the last step [rad]
inline Vec3<double> turned(const Vec3<double>& force, const Vec3<double>& normal, double turn) {
  const double h = 0.5 * turn, t = h * (1 + h * h * (1.0 / 3 + h * h * (2.0 / 15)));
  const double share = 1 / (1 + t * t);
  return share * ((1 - t * t) * force + (2 * t) * cross(normal, force));
}

}  // namespace floe
