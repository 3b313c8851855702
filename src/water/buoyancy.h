/// \file
/// Buoyancy of convex bodies: rho_w g times the exact volume below z = 0, at the centroid of that
/// volume (model.md, "Water").
#pragma once

#include <memory>
#include <vector>

#include "floe/water/wave_options.h"
#include "forces/force.h"
#include "submersion/submersion.h"
#include "submersion/submersion_in_waves.h"

namespace floe {

/// Makes the force of buoyancy on owned bodies.
/// \param part            with shapes; must outlive the force
/// \param weight_density  rho_w g [N/m^3]
/// \throws InputError if the lattice has no shapes
template <class Space>
std::unique_ptr<Force<Space>> make_buoyancy(const Part& part, double weight_density);

/// The same with submerged parts that other forces use too. This force calls them in each step, and
/// keeps them in checkpoints.
std::unique_ptr<Force<Spatial>> make_buoyancy(std::shared_ptr<Submersion> submersion,
                                              double weight_density);

/// Makes the force of buoyancy below a moving surface: the same with the local plane of the waves,
/// rho_w g V (-slope_x, -slope_y, 1) at the centroid of the part below that plane, which is the
/// Froude-Krylov force. All of its work is reported as `energy_external`. For explicit dynamics.
/// \param gravity  [m/s^2]
/// \throws InputError as above, and if a wave is shorter than 8 bodies; collective
std::unique_ptr<Force<Spatial>> make_buoyancy_in_waves(const Part& part, double weight_density,
                                                       double gravity, const WaveOptions& waves);

/// The same with submerged parts that other forces use too, as above.
std::unique_ptr<Force<Spatial>> make_buoyancy(std::shared_ptr<SubmersionInWaves> submersion,
                                              double weight_density);

/// Mass of the water that each owned body displaces at rest [kg].
/// \param density  of the water [kg/m^3]
/// \throws InputError if the lattice has no shapes
std::vector<double> displaced_mass(const Part& part, double density);

}  // namespace floe
