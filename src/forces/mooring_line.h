/// \file
/// Wrenches of mooring lines on structures.
#pragma once

#include <memory>
#include <vector>

#include "floe/forces/mooring_line.h"
#include "forces/force.h"

namespace floe {

/// Lines act on a structure at the fairlead, which goes with it, straight towards the anchor.
/// \param part  must outlive the force
std::unique_ptr<Force<Spatial>> make_mooring_lines(const Part& part,
                                                   std::vector<MooringLine> lines);

}  // namespace floe
