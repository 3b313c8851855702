/// \file
/// What a run is going to write.
#pragma once

#include "floe/output/size.h"
#include "floe/scene.h"
#include "floe/solve/integrator.h"

namespace floe {

/// Rows and frames that a run will write, about.
struct PlannedOutput {
  double rows = 0, frames = 0, bytes = 0;
};
PlannedOutput planned_output(const Scene& scene, const RunPlan& plan, const OutputSize& size);

}  // namespace floe
