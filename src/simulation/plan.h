/// \file
/// Expected steps and output of a run.
#pragma once

#include <string>

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

/// Returns the lines that describe the plan of a run and what it needs.
/// \param memory  of all ranks, at present [bytes]
/// \throws InputError if the run needs more than the scene's limits allow
std::string plan_text(const Scene& scene, const RunPlan& plan, const OutputSize& size,
                      double memory);

}  // namespace floe
