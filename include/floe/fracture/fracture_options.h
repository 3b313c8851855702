/// \file
/// Strengths and fracture energies of beams, as a scene states them (model.md section 11).
#pragma once

#include <cstdint>

namespace floe {

struct FractureOptions {
  double tensile_strength = 6e5;  ///< sigma_t [Pa]
  double shear_strength = 6e5;    ///< tau_c [Pa]
  double energy = 15;             ///< G_f [J/m^2]
  double energy_shear = 15;       ///< G_s [J/m^2]
  bool calibrate = false;         ///< these are the sheet's strengths, not yet the beams'
  double weibull_modulus = 0;     ///< m; 0: all beams have the same strengths
  double weibull_area = 0;        ///< A_ref [m^2]; 0: the mean section of the lattice
  std::uint64_t seed = 1;         ///< of the scatter
  /// Damage follows each evaluation, and velocities tell a step's strains; otherwise (statics)
  /// it moves by advance() only.
  bool dynamic = true;
};

}  // namespace floe
