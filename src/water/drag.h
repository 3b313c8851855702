/// \file
/// Drag of the water on moving bodies.
#pragma once

#include <memory>

#include "floe/water/drag_options.h"
#include "forces/force.h"

namespace floe {

/// Force -(c + rho_w C_d |v|/2) A_plan v times the submerged part of the volume, at the centroid; v
/// is the velocity against the water, A_plan the plan area of the body at rest. Reports as
/// `energy_drag` what bodies have lost to the water; a current also drives them, a gain counts
/// negative. \param part  must outlive the force
/// \throws InputError if the lattice has no shapes
template <class Space>
std::unique_ptr<Force<Space>> make_drag(const Part& part, const DragOptions& options);

}  // namespace floe
