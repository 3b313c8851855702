/// \file
/// Buoyancy of convex bodies: rho_w g times the exact volume below z = 0, at the centroid of that
/// volume (model.md, "Water").
#pragma once

#include <memory>
#include <vector>

#include "forces/force.h"

namespace floe {

/// Makes the force of buoyancy on owned bodies.
/// \param part            with shapes; must outlive the force
/// \param weight_density  rho_w g [N/m^3]
/// \throws InputError if the lattice has no shapes
template <class Space>
std::unique_ptr<Force<Space>> make_buoyancy(const Part& part, double weight_density);

/// Mass of the water that each owned body displaces at rest [kg].
/// \param density  of the water [kg/m^3]
/// \throws InputError if the lattice has no shapes
std::vector<double> displaced_mass(const Part& part, double density);

}  // namespace floe
