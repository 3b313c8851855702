/// \file
/// Drag of the water on moving bodies.
#pragma once

#include <memory>

#include "floe/water/drag_options.h"
#include "forces/force.h"

namespace floe {

/// Makes the force -(c + rho_w C_d |v|/2) A_p (V/V_0) v at the centroid of each owned body, with v
/// the velocity relative to the water, A_p the plan area of the body at rest and V/V_0 the
/// submerged part of its volume (model.md, "Water"). Reports as `energy_drag` the energy that the
/// bodies have lost to the water; energy gained from a current counts as negative.
/// \param part  with shapes; must outlive the force
/// \throws InputError if the lattice has no shapes
template <class Space>
std::unique_ptr<Force<Space>> make_drag(const Part& part, const DragOptions& options);

}  // namespace floe
