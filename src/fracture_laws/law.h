/// \file
/// The law of fracture for one beam, on any scalar where loops need it (model.md, "Fracture").
/// This text is that of every back end: the lanes of a processor (src/fracture/lanes.h) and
/// devices.
///
///     sigma = N/A + |M_2| h/(2 I_y) + |M_3| w/(2 I_z),  tau = |Q|/A + |T| (3 + 1.8 b/a)/(a b^2)
///     s^2 = (<sigma>/sigma_t)^2 + (tau/tau_c)^2         of the forces in an undamaged beam
///     M_2, T and Q_3 with the weight chi
///     with a compressive strength, in a fibre pressed by p, of the extreme ones the worse decides:
///     s = (sqrt(p^2/4 + tau^2) - p/2 sin phi)/tau_c,  sin phi = 1 - 2 tau_c/sigma_c
///     U_d = 1/2 k_n <Delta>^2 + shear, torsion, bending;  U_s its shear and torsion
///     at s = 1:  U_1 = U_d/s^2, beta = U_s/U_d, 1/G = (1 - beta)/G_f + beta/G_s, s_u = G A/U_1
///     D = s_u/(s_u - 1) (1 - 1/kappa), kappa the largest s so far; s_u <= 1: D = 1 at once
///     stored: 1/2 k_n Delta^2 (1 - D (Delta > 0)) + (1 - D) (shear, torsion, bending)
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "beams/kernel.h"
#include "floe/geometry/polyhedron.h"

namespace floe {

/// Factors from section forces to sigma/sigma_t and tau/tau_c.
template <class T>
struct Strength {
  T axial, bending_y, bending_z;  ///< 1/(A sigma_t), h/(2 I_y sigma_t), w/(2 I_z sigma_t)
  T shear, torsion;               ///< 1/(A tau_c), (3 + 1.8 b/a)/(a b^2 tau_c)
};

/// What the criterion needs with weights or with pressure (Criterion::general).
template <class T>
struct FurtherStrength {
  T transverse;  ///< factor of Q_3 in |Q|
  T pressure;    ///< sigma_t/(2 tau_c)
  T friction;    ///< sin phi
};

/// What the criterion of the beams of a lattice looks at. Each costs what it needs only.
enum class Criterion {
  plain,    ///< the strengths in tension and shear
  general,  ///< also FurtherStrength
};

/// Factors of a rectangular section.
/// \param w, h     sides along axes 2 and 3 [m]
/// \param tension  sigma_t [Pa]
/// \param shear    tau_c [Pa]
inline Strength<double> section_strength(double w, double h, double tension, double shear) {
  const double a = std::max(w, h), b = std::min(w, h), area = w * h;
  return {1 / (area * tension), 6 / (area * h * tension), 6 / (area * w * tension),
          1 / (area * shear), (3 + 1.8 * b / a) / (a * b * b * shear)};
}

/// s^2 of the given elastic section forces.
template <class T>
constexpr T criterion(const Strength<T>& c, const BeamStress<T>& e) {
  using std::abs;
  using std::max;
  using std::sqrt;
  const T sigma =
      max(T(0.0), T(e.n * c.axial + abs(e.c.y) * c.bending_y + abs(e.c.z) * c.bending_z));
  const T tau = sqrt(T(e.qy * e.qy + e.qz * e.qz)) * c.shear + abs(e.c.x) * c.torsion;
  return sigma * sigma + tau * tau;
}

/// s^2 in tension and under pressure.
template <class T>
struct Criteria {
  T tension;   ///< <sigma> and tau; under a pressure that friction counts in, 0
  T pressure;  ///< Mohr and Coulomb's; 0 if nothing is pressed or beams do not crush
};

/// Sets s2.tension to 0 where the most stretched fibre is pressed. \param stretch  of that fibre
constexpr void drop_tension_where_pressed(double stretch, Criteria<double>& s2) {
  if (stretch < 0.0) s2.tension = 0.0;
}

/// s^2 of the given elastic section forces, with weights and pressure. With a compressive strength
/// a fibre in tension has the criterion of the plain law and a pressed one that of Mohr and Coulomb
/// on the worst of all planes,
///
///     (sigma_1 - sigma_3)/2 + (sigma_1 + sigma_3)/2 sin phi = c cos phi = tau_c
///
/// (Jaeger, Cook & Zimmerman 2007, Fundamentals of Rock Mechanics, section 4.5), in the stresses -p
/// and tau of a section. Its value is of degree one in the forces, as s is, tau/tau_c at p = 0 and
/// p/sigma_c at tau = 0. It is convex in p, so the two extreme fibres decide.
/// \param crushes  beams have a compressive strength
template <class T>
constexpr Criteria<T> criteria(const Strength<T>& c, const FurtherStrength<T>& f,
                               const BeamStress<T>& e, bool crushes) {
  using std::abs;
  using std::max;
  using std::sqrt;
  const T axial = e.n * c.axial, bent = abs(e.c.y) * c.bending_y + abs(e.c.z) * c.bending_z;
  const T q3 = e.qz * f.transverse;
  const T tau = sqrt(T(e.qy * e.qy + q3 * q3)) * c.shear + abs(e.c.x) * c.torsion;
  const T sigma = max(T(0.0), T(axial + bent));
  Criteria<T> s2{sigma * sigma + tau * tau, T(0.0)};
  if (!crushes) return s2;
  const auto pressed = [&](const T& p) {
    const T half = p * f.pressure;
    const T s = sqrt(T(half * half + tau * tau)) - half * f.friction;
    return T(s * s);
  };
  const T least = max(T(0.0), T(-axial - bent)), most = max(T(0.0), T(bent - axial));
  s2.pressure = max(pressed(least), pressed(most));
  drop_tension_where_pressed(T(axial + bent), s2);
  return s2;
}

/// Factors of the elastic forces of a damaged beam: axial, and the other five.
struct Softening {
  double axial = 1, rest = 1;
};
/// \param whole_axis  not stretched, and pressed beams keep their axial stiffness
constexpr Softening softening(double damage, bool whole_axis, bool broken) {
  return {broken ? 0.0 : whole_axis ? 1.0 : 1 - damage, 1 - damage};
}

/// Energy 1/2 (elastic forces) . strains [J]. Damage reduces all parts but that in compression.
struct DamageEnergy {
  double stretch, squeeze;  ///< axial: in tension, in compression
  double shear, bending;    ///< shear and torsion; bending
  constexpr double damaged() const { return stretch + shear + bending; }
  constexpr double whole() const { return damaged() + squeeze; }
  /// Of a beam that is crushed: what it stores in compression counts as shear, on inclined planes.
  constexpr void crush() { shear += std::exchange(squeeze, 0.0); }
};
/// Bilinear: the forces of one state on the strains of another. With both of one state it is the
/// energy of that state.
constexpr DamageEnergy damage_energy(const BeamStress<double>& e,
                                     const BeamStress<double>& strain) {
  const double axial = 0.5 * e.n * strain.n;
  const bool tension = e.n > 0 && strain.n > 0, pressure = e.n < 0 && strain.n < 0;
  return {tension ? axial : 0.0, pressure ? axial : 0.0,
          0.5 * (e.qy * strain.qy + e.qz * strain.qz + e.c.x * strain.c.x),
          0.5 * (e.c.y * strain.c.y + e.c.z * strain.c.z)};
}

/// History of a beam that has reached its strength.
struct Crack {
  std::int32_t beam = 0;  ///< local index
  double kappa = 1;       ///< largest s so far
  double damage = 0;      ///< D
  double ultimate = 0;    ///< s_u
  double mode_mix = 0;    ///< beta
  double nominal = 0;     ///< G A [J]
  double dissipated = 0;  ///< [J]
  bool at_tip = false;    ///< it broke at a crack's tip, by the strength of tips
  double time = 0;        ///< when it broke [s]
  Point3 place{};         ///< where it broke [m]
  bool crushed = false;   ///< it yields to pressure, so its elongation softens in compression too
  constexpr bool brittle() const { return ultimate <= 1; }
  constexpr bool broken() const { return damage == 1; }
};

/// Sets mode mix, nominal energy and ultimate s of a crack when s has passed 1.
/// \param energy      of the undamaged beam at this state
/// \param area        A [m^2]
/// \param g, g_shear  G_f, G_s [J/m^2]
constexpr void initiate(Crack& crack, const DamageEnergy& energy, double s, double area, double g,
                        double g_shear) {
  const double damaged = energy.damaged();
  crack.mode_mix = damaged > 0 ? energy.shear / damaged : 0;
  crack.nominal = area / ((1 - crack.mode_mix) / g + crack.mode_mix / g_shear);
  crack.ultimate = damaged > 0 ? crack.nominal * s * s / damaged : 1;
}

/// Damage D at kappa >= 1.
constexpr double damage_at(const Crack& crack, double kappa) {
  if (kappa >= crack.ultimate || crack.brittle()) return 1;
  return std::min(1.0, crack.ultimate / (crack.ultimate - 1) * (1 - 1 / kappa));
}

/// Growth of the damage of a beam whose s has passed its kappa.
struct Growth {
  Crack crack;            ///< after the growth
  double released = 0;    ///< decrease of the stored energy [J]
  double dissipated = 0;  ///< energy dissipated by the growth [J]
};

/// Whether a beam breaks whatever its kappa: at a tip, or crushed after it was damaged otherwise,
/// since then it is too weak to be crushed gradually. \param crushing  pressure is the worst for it
constexpr bool breaks_at_once(const Crack* known, bool crushing, bool at_tip) {
  return at_tip || (crushing && known != nullptr && !known->crushed);
}

/// Returns the crack of a beam at s, which has passed its kappa.
/// \param known    its crack before; null: none
/// \param energy   of the undamaged beam at this state; becomes as it counts for the crack
/// \param area     A [m^2]
/// \param g, g_shear  G_f, G_s [J/m^2]
constexpr Crack grown(const Crack* known, double s, bool crushing, bool at_tip,
                      DamageEnergy& energy, double area, double g, double g_shear) {
  Crack next = known != nullptr ? *known : Crack{};
  if (known == nullptr) next.crushed = crushing;
  if (next.crushed) energy.crush();
  if (known == nullptr) initiate(next, energy, s, area, g, g_shear);
  next.kappa = std::max(s, next.kappa);
  next.damage = breaks_at_once(known, crushing, at_tip) ? 1 : damage_at(next, s);
  next.at_tip = at_tip;
  return next;
}

/// Adds what a growth dissipates.
/// \param before  D before it \param energy  as grown() leaves it
/// \param path    the same of the forces on the strains along the way to this state
constexpr Growth dissipating(Crack next, double before, bool crushing, const DamageEnergy& energy,
                             const DamageEnergy& path) {
  Growth g;
  g.dissipated = std::max(0.0, path.damaged() * (next.damage - before));
  g.released = energy.damaged() * (next.damage - before);
  if (next.broken()) {
    next.crushed = next.crushed || crushing;
    g.dissipated += path.squeeze;
    g.released += energy.squeeze;
  }
  next.dissipated += g.dissipated;
  g.crack = next;
  return g;
}

/// In dynamics: damage energy of the forces of a state on the strains of the last one, dt before.
constexpr DamageEnergy energy_over_step(const Crack& next, const BeamStress<double>& force,
                                        const BeamStress<double>& strain,
                                        const BeamStress<double>& rate, double dt) {
  DamageEnergy path = damage_energy(force, {strain.n - dt * rate.n, strain.qy - dt * rate.qy,
                                            strain.qz - dt * rate.qz, strain.c - dt * rate.c});
  if (next.crushed) path.crush();
  return path;
}

}  // namespace floe
