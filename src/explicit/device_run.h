/// \file
/// Runs by leapfrog on a back end that keeps the state.
#pragma once

#include <memory>

#include "explicit/explicit.h"

namespace floe {

/// Makes a run whose steps an engine makes (src/device). Samples, stable steps, checkpoints and all
/// else are those of the processor, on the state that is brought back for them.
/// \throws InputError for what the engine cannot compute
std::unique_ptr<Run> make_device_run(Model<Spatial>& model, const ExplicitOptions& options,
                                     Observer<Spatial> observer);

}  // namespace floe
