/// \file
/// Expected memory of a run on a sheet.
#pragma once

#include "floe/scene.h"

namespace floe {

/// Checks, before a sheet is meshed, whether there is enough memory for the run, by an estimate.
/// Warns on rank 0 if the run takes more memory than is free.
/// \param free  free memory [B]; must be the same on all ranks
/// \throws InputError if the run takes more than the scene's limit, or, without a limit, more than
///   three times what is free
void check_size(const Scene& scene, double free, int ranks);

}  // namespace floe
