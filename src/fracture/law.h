/// \file
/// The law of fracture for one beam, on any scalar where loops need it (model.md, "Fracture").
///
///     sigma = N/A + |M_2| h/(2 I_y) + |M_3| w/(2 I_z),  tau = |Q|/A + |T| (3 + 1.8 b/a)/(a b^2)
///     s^2 = (<sigma>/sigma_t)^2 + (tau/tau_c)^2         of the forces in an undamaged beam
///     U_d = 1/2 k_n <Delta>^2 + shear, torsion, bending;  U_s its shear and torsion
///     at s = 1:  U_1 = U_d/s^2, beta = U_s/U_d, 1/G = (1 - beta)/G_f + beta/G_s, s_u = G A/U_1
///     D = s_u/(s_u - 1) (1 - 1/kappa), kappa the largest s so far; s_u <= 1: D = 1 at once
///     stored: 1/2 k_n Delta^2 (1 - D (Delta > 0)) + (1 - D) (shear, torsion, bending)
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "base/simd.h"
#include "beams/kernel.h"

namespace floe {

/// Factors from section forces to sigma/sigma_t and tau/tau_c.
template <class T>
struct Strength {
  T axial, bending_y, bending_z;  ///< 1/(A sigma_t), h/(2 I_y sigma_t), w/(2 I_z sigma_t)
  T shear, torsion;               ///< 1/(A tau_c), (3 + 1.8 b/a)/(a b^2 tau_c)
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
T criterion(const Strength<T>& c, const BeamStress<T>& e) {
  using std::abs;
  using std::max;
  using std::sqrt;
  const T sigma =
      max(T(0.0), T(e.n * c.axial + abs(e.c.y) * c.bending_y + abs(e.c.z) * c.bending_z));
  const T tau = sqrt(T(e.qy * e.qy + e.qz * e.qz)) * c.shear + abs(e.c.x) * c.torsion;
  return sigma * sigma + tau * tau;
}

/// Factors of the elastic forces of a damaged beam: axial, and the other five.
struct Softening {
  double axial = 1, rest = 1;
};
inline Softening softening(double damage, bool stretched, bool broken) {
  return {broken ? 0.0 : stretched ? 1 - damage : 1.0, 1 - damage};
}

/// Energy 1/2 (elastic forces) . strains [J]. Damage reduces all parts but that in compression.
struct DamageEnergy {
  double stretch, squeeze;  ///< axial: in tension, in compression
  double shear, bending;    ///< shear and torsion; bending
  double damaged() const { return stretch + shear + bending; }
  double whole() const { return damaged() + squeeze; }
};
/// Bilinear: the forces of one state on the strains of another. With both of one state it is the
/// energy of that state.
inline DamageEnergy damage_energy(const BeamStress<double>& e, const BeamStress<double>& strain) {
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
  bool brittle() const { return ultimate <= 1; }
  bool broken() const { return damage == 1; }
};

/// Sets mode mix, nominal energy and ultimate s of a crack when s has passed 1.
/// \param energy      of the undamaged beam at this state
/// \param area        A [m^2]
/// \param g, g_shear  G_f, G_s [J/m^2]
inline void initiate(Crack& crack, const DamageEnergy& energy, double s, double area, double g,
                     double g_shear) {
  const double damaged = energy.damaged();
  crack.mode_mix = damaged > 0 ? energy.shear / damaged : 0;
  crack.nominal = area / ((1 - crack.mode_mix) / g + crack.mode_mix / g_shear);
  crack.ultimate = damaged > 0 ? crack.nominal * s * s / damaged : 1;
}

/// Damage D at kappa >= 1.
inline double damage_at(const Crack& crack, double kappa) {
  if (kappa >= crack.ultimate || crack.brittle()) return 1;
  return std::min(1.0, crack.ultimate / (crack.ultimate - 1) * (1 - 1 / kappa));
}

}  // namespace floe
