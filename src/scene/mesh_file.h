/// \file
/// Relaxed generators of a sheet, kept in a file: scenes that share a sheet share the work of its
/// mesh.
#pragma once

#include <functional>
#include <string>

#include "floe/mesh/tessellation.h"

namespace floe {

/// The tessellation of a plan: from the file if it is there, else relaxed as the plan says. Either
/// way cells are made from the generators in the same manner, so that the result is the same to the
/// last bit. Collective. \param keep  writes the file if it was not there; to be called once all
/// else is known to be good \throws InputError if the file is another plan's, or no mesh file at
/// all
Tessellation tessellate_with_file(const SheetPlan& plan, const std::string& file, MPI_Comm comm,
                                  const std::function<void(int, double)>& on_iteration,
                                  std::function<void()>& keep);

}  // namespace floe
