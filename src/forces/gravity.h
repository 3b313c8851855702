/// \file
/// Weight of the bodies.
#pragma once

#include <memory>

#include "forces/force.h"

namespace floe {

/// Makes the force -m g along z, at the centroid of each owned body.
/// \param part          must outlive the force
/// \param acceleration  g [m/s^2]
template <class Space>
std::unique_ptr<Force<Space>> make_gravity(const Part& part, double acceleration);

}  // namespace floe
