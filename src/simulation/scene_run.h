/// \file
/// The run of a scene's integrator.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "floe/scene.h"
#include "forces/dead_load.h"
#include "lattice/archive.h"
#include "model/model.h"
#include "run/integrator.h"
#include "run/run.h"
#include "statics/quasistatic.h"

namespace floe {

/// Returns the path of a run's checkpoint.
std::string checkpoint_file(const Scene& scene);

/// The surroundings of a run.
struct RunHooks {
  std::string lattice_id;  ///< fingerprint of the lattice, for checkpoints
  OnPlan on_plan;          ///< receives the plan before the first step; false: no run is made
  std::function<void(const std::vector<std::string>&)> prepare;  ///< CheckpointOptions::prepare
  std::function<void(Archive&)> others;                          ///< CheckpointOptions::others
  BalanceOptions balance;                                        ///< for explicit runs with contact
  std::optional<SupplyOptions> supply;                           ///< for ice without end
  std::string program;  ///< what a program does to the model, for checkpoints; empty: nothing
  std::function<void(const std::vector<std::int32_t>&)> remake;  ///< DynamicOptions::remake
  std::function<bool()> wants_pause;                             ///< CheckpointOptions
  const std::vector<PlacedLoad>* loads = nullptr;                ///< for static: monitor
};

/// Makes the run of the scene's integrator. Collective.
/// \param out_of_plane  the part that a planar model leaves out; null for a spatial model
template <class Space>
std::unique_ptr<Run> make_run(const Scene& scene, Model<Space>& model,
                              const OutOfPlane* out_of_plane, const RunHooks& hooks,
                              ObserverOf<Space> observer);

}  // namespace floe
