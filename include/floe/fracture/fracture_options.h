/// \file
/// Strengths and fracture energies of beams, as a scene states them (model.md, "Fracture").
#pragma once

#include <cstdint>

namespace floe {

/// What decides on the breaks of beams at the tips of cracks.
enum class Propagation {
  strength,  ///< the strengths, as everywhere
  energy,    ///< strengths that make a crack cost its fracture energy, whatever the mesh
};

/// Options of fracture, for all beams of a lattice.
struct FractureOptions {
  double tensile_strength = 6e5;    ///< sigma_t [Pa]
  double shear_strength = 6e5;      ///< tau_c [Pa]
  double flexural_strength = 0;     ///< nominal, of the sheet [Pa]; 0: as its beams give it
  double compressive_strength = 0;  ///< sigma_c [Pa]; 0: beams do not crush
  /// chi: weight of bending out of the plane, torsion and shear along axis 3 in the criterion.
  double bending_factor = 1;
  double energy = 15;          ///< G_f [J/m^2]
  double energy_shear = 15;    ///< G_s [J/m^2]
  bool calibrate = false;      ///< the strengths are those of the sheet, not yet of its beams
  double weibull_modulus = 0;  ///< m; 0: all beams have the same strengths
  double weibull_area = 0;     ///< A_ref [m^2]; 0: the mean section of the lattice
  std::uint64_t seed = 1;      ///< of the scatter
  Propagation propagation = Propagation::strength;
  /// Damage follows each evaluation, with the strain increments of a step taken from velocities;
  /// false (statics): damage changes by Fracture::advance() only.
  bool dynamic = true;
};

}  // namespace floe
