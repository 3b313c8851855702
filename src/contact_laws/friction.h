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
  double energy() const { return 0.5 * dot(force, force) / stiffness; }
};

/// Returns the force of the springs in the tangent plane of the present normal: turned into this
/// plane at equal size, and scaled down if the stiffness has fallen [N].
/// \param last       the springs after the last step
/// \param normal     of the contact, a unit vector
/// \param stiffness  present k_t [N/m]
inline Vec3<double> carried(const FrictionSprings& last, const Vec3<double>& normal,
                            double stiffness) {
  const Vec3<double>& f = last.force;
  const double before = length(f);
  if (before == 0) return {};
  const Vec3<double> in_plane = f - dot(f, normal) * normal;
  const double size = length(in_plane);
  if (size == 0) return {};
  const double falls = stiffness < last.stiffness ? stiffness / last.stiffness : 1.0;
  return (falls * before / size) * in_plane;
}

/// Returns the springs in an evaluation: carried, and cut to the largest friction.
/// \param most  mu times the normal force [N]
inline FrictionSprings cut(const FrictionSprings& last, const Vec3<double>& normal,
                           double stiffness, double most) {
  Vec3<double> force = carried(last, normal, stiffness);
  const double size = length(force);
  if (size > most) force = (most / size) * force;
  return {.stiffness = stiffness, .force = force};
}

/// Returns the springs after a step: they turn with the bodies about the normal and follow the
/// sliding.
/// \param springs    in the evaluation at the start of the step
/// \param normal     of the contact; zero if there is no force
/// \param velocity   of A relative to B in the step [m/s]
/// \param mean_spin  mean of the spins of A and B [rad/s]
/// \param dt         length of the step [s]
inline FrictionSprings slid(const FrictionSprings& springs, const Vec3<double>& normal,
                            const Vec3<double>& velocity, const Vec3<double>& mean_spin,
                            double dt) {
  if (dot(normal, normal) == 0 || springs.stiffness == 0) return springs;
  const double turn = dt * dot(mean_spin, normal);
  const Vec3<double> turned =
      std::cos(turn) * springs.force + std::sin(turn) * cross(normal, springs.force);
  const Vec3<double> slip = velocity - dot(velocity, normal) * normal;
  return {.stiffness = springs.stiffness, .force = turned - (dt * springs.stiffness) * slip};
}

}  // namespace floe
