/// \file
/// What a run is going to write.
#pragma once

#include "floe/run/result.h"
#include "floe/scene.h"
#include "output/size.h"

namespace floe {

/// Rows and frames that a run will write, about.
struct PlannedOutput {
  double rows = 0, frames = 0, bytes = 0;
};
PlannedOutput planned_output(const Scene& scene, const RunPlan& plan, const OutputSize& size);

/// Before a sheet is meshed: whether the run will find room. Warns, on rank 0, if it takes more
/// memory than is free, by an estimate. \param free  memory that is free [B]; must be the same on
/// all ranks   \throws InputError if it takes more than the scene's limit, or three times what is
/// free
void check_size(const Scene& scene, double free, int ranks);

}  // namespace floe
