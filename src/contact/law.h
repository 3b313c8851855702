/// \file
/// The law of one contact: from an overlap to forces (model.md, "Contact").
#pragma once

#include "floe/contact/contact_options.h"
#include "geometry/overlap.h"

namespace floe {

/// Damping ratio zeta with which a central impact of a face returns the part e of its speed:
/// without tension e = exp(-2 zeta arccos(zeta)/sqrt(1 - zeta^2)), and its continuation for
/// zeta > 1.
/// \param restitution  e, in (0, 1]
double damping_ratio_of(double restitution);

/// Constants of a pair.
struct PairConstants {
  double stiffness = 0;     ///< k_v = E_c/(L_a + L_b) [Pa/m]
  double area = 0;          ///< A_r [m^2]
  double mass = 0;          ///< m_r [kg]
  double friction = 0;      ///< mu
  bool half_space = false;  ///< whether B is a half-space
};

/// History of a pair.
struct PairHistory {
  double plastic = 0;         ///< V_p [m^3]
  double shear = 0;           ///< k_t of the last step [N/m]
  Vec3<double> tangential{};  ///< F_t on A, of the springs of friction [N]
};

/// Relative motion of the two bodies at a contact.
struct RelativeMotion {
  Vec3<double> velocity{};  ///< of A relative to B at c [m/s]
  Vec3<double> spin{};      ///< omega_A - omega_B [rad/s]
};

/// The wrench of one contact on A, about the centroid of the overlap; that on B is the opposite.
struct ContactForce {
  Vec3<double> normal{};            ///< from B to A; zero if there is no force
  double elastic = 0, viscous = 0;  ///< along the normal [N]
  Vec3<double> couple{};            ///< elastic; zero with law overlap [N m]
  PairHistory memory;               ///< for the commit; its tangential force acts now

  Vec3<double> force() const { return (elastic + viscous) * normal + memory.tangential; }
};
/// Energy that a contact stores [J].
struct StoredEnergy {
  double normal = 0, tangential = 0;
};

/// Force of a contact.
/// \param o               the overlap in world axes, with V > 0
/// \param depth           of its centroid below the plane of a half-space [m]; else not used
/// \param motion          of A relative to B at the centroid of the overlap
/// \param memory          history of the pair
/// \param newly_eligible  the overlap is stress-free: V_p = V
/// \param[out] stored     energy that the contact stores
ContactForce contact_force(const ContactOptions& options, const PairConstants& pair,
                           const Overlap& o, double depth, const RelativeMotion& motion,
                           const PairHistory& memory, bool newly_eligible, StoredEnergy& stored);

/// History of a pair after a step: the springs of friction follow the sliding and turn with the
/// bodies.
/// \param contact    result of contact_force() at the start of the step
/// \param motion     of A relative to B in the step
/// \param mean_spin  mean of the spins of the two bodies [rad/s]
/// \param dt         length of the step [s]
PairHistory slid(const ContactForce& contact, const RelativeMotion& motion,
                 const Vec3<double>& mean_spin, double dt);

}  // namespace floe
