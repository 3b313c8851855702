/// \file
/// Weight of the bodies.
#pragma once

#include <memory>

#include "forces/force.h"

namespace floe {

/// Force -m g along z. \param acceleration g [m/s^2]   \param part  must outlive the force
template <class Space>
std::unique_ptr<Force<Space>> make_gravity(const Part& part, double acceleration);

}  // namespace floe
