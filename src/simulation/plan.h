/// \file
/// Expected output and memory of a run.
#pragma once

#include "floe/run/result.h"
#include "floe/scene.h"
#include "run_folder/size.h"

namespace floe {

/// Approximate numbers of rows, frames and bytes that a run will write.
struct PlannedOutput {
  double rows = 0, frames = 0, bytes = 0;
};
/// Estimates the output of a run.
PlannedOutput planned_output(const Scene& scene, const RunPlan& plan, const OutputSize& size);

/// Checks, before a sheet is meshed, whether there is enough memory for the run, by an estimate.
/// Warns on rank 0 if the run takes more memory than is free.
/// \param free  free memory [B]; must be the same on all ranks
/// \throws InputError if the run takes more than the scene's limit, or, without a limit, more than
///   three times what is free
void check_size(const Scene& scene, double free, int ranks);

}  // namespace floe
