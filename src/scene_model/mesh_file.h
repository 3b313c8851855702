/// \file
/// Relaxed generators of a sheet, kept in a file, so that scenes of the same sheet mesh it only
/// once.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "floe/mesh/tessellation.h"

namespace floe {

/// Makes the tessellations of a sheet's meshed_boxes(): from the file if it exists, else relaxed as
/// the plan says. In both cases cells are made from the generators in the same way, so that the
/// result is the same to the last bit. Collective.
/// \param keep  set to a function that writes the file, if it did not exist; to be called when
///   everything else is known to be good
/// \throws InputError if the file is that of another plan, or no mesh file
std::vector<Tessellation> tessellate_with_file(const SheetPlan& plan, const std::string& file,
                                               MPI_Comm comm,
                                               const std::function<void(int, double)>& on_iteration,
                                               std::function<void()>& keep);

}  // namespace floe
