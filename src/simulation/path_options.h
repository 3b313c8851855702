/// \file
/// Settings of a static run along a path, from the scene.
#pragma once

#include "paths/path.h"
#include "simulation/scene_run.h"

namespace floe {

/// \param model  must outlive the options
template <class Space>
PathOptions<Space> path_options(const Scene& scene, const Model<Space>& model,
                                const RunHooks& hooks);

}  // namespace floe
