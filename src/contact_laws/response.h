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
struct PairConstants {
  double stiffness = 0;     ///< k_v = E_c/(L_a + L_b) [Pa/m]
  double area = 0;          ///< A_r [m^2]
  double friction = 0;      ///< mu at the contact's place
  bool half_space = false;  ///< whether B is a half-space
};

/// History of a pair.
struct PairHistory {
  double plastic = 0;       ///< V_p [m^3]
  FrictionSprings springs;  ///< at the last step
  TwistSpring twist;        ///< at the last step

  static constexpr std::size_t numbers = 7;
  /// Returns V_p, k_t, the three components of F_t, the stiffness of the twist and M_n, as a
  /// checkpoint holds them.
  std::array<double, numbers> as_numbers() const {
    const Vec3<double>& f = springs.force;
    return {plastic, springs.stiffness, f.x, f.y, f.z, twist.stiffness, twist.couple};
  }
  /// Returns the history that gave these numbers.
  static PairHistory from(std::span<const double, numbers> n) {
    return {.plastic = n[0],
            .springs = {.stiffness = n[1], .force = {n[2], n[3], n[4]}},
            .twist = {.stiffness = n[5], .couple = n[6]}};
  }
};

/// Relative motion of the two bodies at a contact.
struct RelativeMotion {
  Vec3<double> velocity{};  ///< of A relative to B at c [m/s]
  Vec3<double> spin{};      ///< omega_A - omega_B [rad/s]
};

/// The last step, after which a contact is evaluated. Velocities lag half of it behind.
struct LastStep {
  double dt = 0;         ///< [s]; 0 before the first step
  bool touched = true;   ///< whether the pair touched at its start
  double mean_turn = 0;  ///< of the bodies about the normal [rad]
};

/// A contact in an evaluation, as a law sees it.
struct ContactState {
  const PairConstants& pair;
  const Overlap& overlap;        ///< in world axes, with V > 0
  double depth = 0;              ///< of c below the plane of B where B is a half-space [m]
  const RelativeMotion& motion;  ///< in the middle of the last step
  const Mobility& mobility;
  LastStep last;
  double area = 0;        ///< |S| [m^2]
  Vec3<double> normal{};  ///< n = S/|S|, from B to A

  /// Returns the part of the overlap that presses, V - V_p [m^3].
  double elastic_volume(double plastic) const { return std::max(overlap.volume - plastic, 0.0); }
};

/// The elastic force of a law, proportional to V - V_p.
struct ElasticTerm {
  double rate = 0;        ///< force per volume [N/m^3]
  Vec3<double> couple{};  ///< couple about the centroid of the overlap per volume [N m/m^3]
  double stiffness = 0;   ///< along n [N/m]
};

/// The dashpots of a contact: coefficients with which they act over a step.
struct Dashpots {
  double normal = 0;          ///< against approach at the middle of the facets [N s/m]
  Vec3<double> arm{};         ///< of the middle of the facets, from the centroid of the overlap [m]
  double area = 0;            ///< c/|S| of the viscous pressure, before it slows bodies [N s/m^3]
  double counts = 1;          ///< part of the step in which the viscous pressure acts
  double slip = 0;            ///< against slip [N s/m]
  double twist = 0;           ///< against spin about n [N m s]
  double widest = 0;          ///< square root of (largest eigenvalue of T)/|S| [m]
  SymmetricMatrix turning{};  ///< I_A^-1 + I_B^-1 [1/(kg m^2)]
};

/// A contact of an evaluation before its dashpots act: all that does not depend on the velocities
/// to come.
struct ContactTrial {
  Vec3<double> normal{};  ///< from B to A; zero if there is no direction, hence no force
  double elastic = 0;     ///< along n [N]
  Vec3<double> couple{};  ///< elastic [N m]
  double yield = 0;       ///< largest force along n [N]
  double friction = 0;    ///< mu
  double reach = 0;       ///< r_eff [m]
  Friction springs;       ///< of friction, before their limit
  PairHistory memory;     ///< V_p and stiffnesses of the springs
  double volume = 0;      ///< V [m^3]
  double area = 0;        ///< |S| [m^2]
  double depth = 0;       ///< of c below the plane of B where B is a half-space [m]
  PairConstants pair;
  double dt = 0;      ///< of the last step [s]
  Dashpots dashpots;  ///< zeros without damping
  Patch patch;        ///< of the overlap, with damping
};

/// The wrench of a contact on A, about the centroid of the overlap; that on B is the opposite.
struct ContactForce {
  Vec3<double> normal{};            ///< from B to A; zero if there is no force
  double elastic = 0, viscous = 0;  ///< along the normal [N]
  Vec3<double> couple{};            ///< elastic [N m]
  Vec3<double> viscous_couple{};    ///< of the viscous pressure [N m]
  Friction friction;                ///< of springs and dashpots
  Friction springs;                 ///< of springs alone, for the commit

  Vec3<double> force() const { return (elastic + viscous) * normal + friction.force; }
  /// Returns the couple of all terms [N m].
  Vec3<double> whole_couple() const { return couple + viscous_couple + friction.couple * normal; }
};

/// Returns the history after a contact that ended with these springs.
inline PairHistory history_of(const ContactTrial& trial, const Friction& springs) {
  PairHistory now = trial.memory;
  now.springs.force = springs.force;
  now.twist.couple = springs.couple;
  return now;
}

/// Energy that a contact stores [J].
struct StoredEnergy {
  double normal = 0, tangential = 0;
};

}  // namespace floe
