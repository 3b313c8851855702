/// \file
/// What a contact law is given, and what it makes of a contact.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>

#include "contact_laws/friction.h"
#include "contact_laws/mobility.h"
#include "geometry/overlap.h"

namespace floe {

/// Constants of a pair.
template <class T>
struct PairConstantsOf {
  T stiffness = 0;   ///< k_v = E_c/(L_a + L_b) [Pa/m]
  T area = 0;        ///< A_r [m^2]
  T friction = 0;    ///< mu at the contact's place
  T half_space = 0;  ///< 1 where B is a half-space, else 0
};
using PairConstants = PairConstantsOf<double>;

/// Returns k_v and A_r of a body on an obstacle. \param young  E_c [Pa] \param size  L [m]
constexpr PairConstants ice_on_obstacle(double young, double size) {
  return {.stiffness = young / (0.5 * size), .area = size * size};
}
/// Returns those of two bodies; a size of 0 is that of a part that no body carries.
constexpr PairConstants ice_on_ice(double young, double size, double other_size) {
  const double smaller = other_size > 0 && other_size < size ? other_size : size;
  return {.stiffness = young / (0.5 * (size + other_size)), .area = smaller * smaller};
}

/// History of a pair.
template <class T>
struct PairHistoryOf {
  T plastic = 0;                 ///< V_p [m^3]
  FrictionSpringsOf<T> springs;  ///< at the last step
  TwistSpringOf<T> twist;        ///< at the last step

  static constexpr std::size_t numbers = 7;
  /// Returns V_p, k_t, the three components of F_t, the stiffness of the twist and M_n, as a
  /// checkpoint holds them.
  std::array<double, numbers> as_numbers() const {
    const Vec3<T>& f = springs.force;
    return {plastic, springs.stiffness, f.x, f.y, f.z, twist.stiffness, twist.couple};
  }
  /// Returns the history that gave these numbers.
  static PairHistoryOf from(std::span<const double, numbers> n) {
    return {.plastic = n[0],
            .springs = {.stiffness = n[1], .force = {n[2], n[3], n[4]}},
            .twist = {.stiffness = n[5], .couple = n[6]}};
  }
};
using PairHistory = PairHistoryOf<double>;

/// Returns the history of two contacts that have become one.
inline PairHistory joined(const PairHistory& one, const PairHistory& other) {
  std::array<double, PairHistory::numbers> sum = one.as_numbers();
  const auto more = other.as_numbers();
  for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += more[k];
  return PairHistory::from(sum);
}

/// Relative motion of the two bodies at a contact.
template <class T>
struct RelativeMotionOf {
  Vec3<T> velocity{};  ///< of A relative to B at c [m/s]
  Vec3<T> spin{};      ///< omega_A - omega_B [rad/s]
};
using RelativeMotion = RelativeMotionOf<double>;

/// The last step, after which a contact is evaluated. Velocities lag half of it behind.
template <class T>
struct LastStepOf {
  T dt = 0;                 ///< [s]; 0 before the first step
  MaskOf<T> touched{true};  ///< whether the pair touched at its start
  T mean_turn = 0;          ///< of the bodies about the normal [rad]
};
using LastStep = LastStepOf<double>;

/// A contact in an evaluation, as a law sees it.
template <class T>
struct ContactStateOf {
  const PairConstantsOf<T>& pair;
  const OverlapOf<T>& overlap;        ///< in world axes, with V > 0
  T depth = 0;                        ///< of c below the plane of B where B is a half-space [m]
  const RelativeMotionOf<T>& motion;  ///< in the middle of the last step
  const MobilityOf<T>& mobility;
  LastStepOf<T> last;
  T area = 0;        ///< |S| [m^2]
  Vec3<T> normal{};  ///< n = S/|S|, from B to A

  /// Returns the part of the overlap that presses, V - V_p [m^3].
  constexpr T elastic_volume(T plastic) const {
    return larger_of(T(overlap.volume - plastic), T(0.0));
  }
};
using ContactState = ContactStateOf<double>;

/// The elastic force of a law, proportional to V - V_p.
template <class T>
struct ElasticTermOf {
  T rate = 0;        ///< force per volume [N/m^3]
  Vec3<T> couple{};  ///< couple about the centroid of the overlap per volume [N m/m^3]
  T stiffness = 0;   ///< along n [N/m]
};
using ElasticTerm = ElasticTermOf<double>;

/// The dashpots of a contact: coefficients with which they act over a step.
template <class T>
struct DashpotsOf {
  T normal = 0;   ///< against approach at the middle of the facets [N s/m]
  Vec3<T> arm{};  ///< of the middle of the facets, from the centroid of the overlap [m]
  T area = 0;     ///< c/|S| of the viscous pressure, before it slows bodies [N s/m^3]
  T counts = 1;   ///< part of the step in which the viscous pressure acts
  T slip = 0;     ///< against slip [N s/m]
  T twist = 0;    ///< against spin about n [N m s]
  T widest = 0;   ///< square root of (largest eigenvalue of T)/|S| [m]
  SymmetricMatrixOf<T> turning{};  ///< I_A^-1 + I_B^-1 [1/(kg m^2)]
};
using Dashpots = DashpotsOf<double>;

/// A contact of an evaluation before its dashpots act: all that does not depend on the velocities
/// to come.
template <class T>
struct ContactTrialOf {
  Vec3<T> normal{};         ///< from B to A; zero if there is no direction, hence no force
  T elastic = 0;            ///< along n [N]
  Vec3<T> couple{};         ///< elastic [N m]
  T yield = 0;              ///< largest force along n [N]
  T friction = 0;           ///< mu
  T reach = 0;              ///< r_eff [m]
  FrictionOf<T> springs;    ///< of friction, before their limit
  PairHistoryOf<T> memory;  ///< V_p and stiffnesses of the springs
  T volume = 0;             ///< V [m^3]
  T area = 0;               ///< |S| [m^2]
  T depth = 0;              ///< of c below the plane of B where B is a half-space [m]
  PairConstantsOf<T> pair;
  T dt = 0;                ///< of the last step [s]
  DashpotsOf<T> dashpots;  ///< zeros without damping
  PatchOf<T> patch;        ///< of the overlap, with damping
};
using ContactTrial = ContactTrialOf<double>;

/// The wrench of a contact on A, about the centroid of the overlap; that on B is the opposite.
template <class T>
struct ContactForceOf {
  Vec3<T> normal{};            ///< from B to A; zero if there is no force
  T elastic = 0, viscous = 0;  ///< along the normal [N]
  Vec3<T> couple{};            ///< elastic [N m]
  Vec3<T> viscous_couple{};    ///< of the viscous pressure [N m]
  FrictionOf<T> friction;      ///< of springs and dashpots
  FrictionOf<T> springs;       ///< of springs alone, for the commit

  constexpr Vec3<T> force() const { return (elastic + viscous) * normal + friction.force; }
  /// Returns the couple of all terms [N m].
  constexpr Vec3<T> whole_couple() const {
    return couple + viscous_couple + friction.couple * normal;
  }
};
using ContactForce = ContactForceOf<double>;

/// Returns the history after a contact that ended with these springs.
template <class T>
PairHistoryOf<T> history_of(const ContactTrialOf<T>& trial, const FrictionOf<T>& springs) {
  PairHistoryOf<T> now = trial.memory;
  now.springs.force = springs.force;
  now.twist.couple = springs.couple;
  return now;
}

/// Energy that a contact stores [J].
struct StoredEnergy {
  double normal = 0, tangential = 0;
};

}  // namespace floe
