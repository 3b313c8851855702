/// \file
/// The law of one contact: from an overlap to forces (docs/model.md, "Contact").
#pragma once

#include "floe/contact/contact_options.h"
#include "geometry/overlap.h"

namespace floe {

/// zeta with which a central impact of a face returns the part e of its speed: without tension
/// e = exp(-2 zeta arccos(zeta)/sqrt(1 - zeta^2)), and its continuation above 1.
/// \param restitution  in (0, 1]
double damping_ratio_of(double restitution);

/// What is fixed for a pair.
struct PairConstants {
  double stiffness = 0;  ///< k_v = E_c/(L_a + L_b) [Pa/m]
  double area = 0;       ///< A_r [m^2]
  double mass = 0;       ///< m_r [kg]
  double friction = 0;   ///< mu
  bool half_space = false;
};

/// What a pair remembers between steps.
struct PairHistory {
  double plastic = 0;         ///< V_p [m^3]
  double shear = 0;           ///< k_t of the last step [N/m]
  Vec3<double> tangential{};  ///< F_t on A, as the springs have it now [N]
};

/// How the two bodies move against each other at the contact.
struct RelativeMotion {
  Vec3<double> velocity{};  ///< of A against B at c [m/s]
  Vec3<double> spin{};      ///< omega_A - omega_B [rad/s]
};

/// The wrench of one contact on A, about the overlap's centroid; on B it is the opposite.
struct ContactForce {
  Vec3<double> normal{};            ///< from B to A; zero if there is no force
  double elastic = 0, viscous = 0;  ///< along the normal [N]
  Vec3<double> couple{};            ///< elastic; zero with law overlap [N m]
  PairHistory memory;               ///< if this evaluation is committed: its tangential force acts

  Vec3<double> force() const { return (elastic + viscous) * normal + memory.tangential; }
};
/// Energy that a contact stores [J].
struct StoredEnergy {
  double normal = 0, tangential = 0;
};

/// \param o  the overlap in world axes, with V > 0   \param depth  of its centroid below the plane
/// of a half-space [m]; not used otherwise   \param newly_eligible  the pair may touch since now:
/// what it overlaps by is plastic   \param[out] stored  what the contact stores
ContactForce contact_force(const ContactOptions& options, const PairConstants& pair,
                           const Overlap& o, double depth, const RelativeMotion& motion,
                           const PairHistory& memory, bool newly_eligible, StoredEnergy& stored);

/// What the pair remembers after a step: the springs of friction, moved on. \param contact  as
/// contact_force left it   \param mean_spin  of the two bodies
PairHistory slid(const ContactForce& contact, const RelativeMotion& motion,
                 const Vec3<double>& mean_spin, double dt);

}  // namespace floe
