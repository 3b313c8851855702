#include "simulation/scene_run.h"

#include <string>
#include <utility>
#include <vector>

#include "explicit/explicit.h"
#include "implicit/implicit.h"
#include "simulation/path_options.h"

namespace floe {

namespace {

std::string fingerprints(const std::vector<SceneTable>& tables) {
  std::string lines;
  for (const SceneTable& table : tables) lines += table.key + ": " + fingerprint(table.rows) + "\n";
  return lines;
}

}  // namespace

std::string checkpoint_file(const Scene& scene) { return scene.output.dir + "/checkpoint.h5"; }

template <class Space>
std::unique_ptr<Run> make_run(const Scene& scene, Model<Space>& model,
                              const OutOfPlane* out_of_plane, const RunHooks& hooks,
                              ObserverOf<Space> observer) {
  if (scene.path_control.arc)
    return make_path_run(model, path_options(scene, model, hooks), std::move(observer),
                         out_of_plane);
  if (scene.integrator == Integrator::quasistatic)
    return make_quasistatic_run(model,
                                {.end = scene.time.end,
                                 .dt = scene.time.dt,
                                 .most_steps = scene.limit.steps,
                                 .on_plan = hooks.on_plan},
                                std::move(observer), out_of_plane);
  ExplicitOptions options;
  options.end = scene.time.end;
  options.dt = scene.time.dt;
  options.velocity_limit = scene.limit.velocity;
  options.energy_limit = scene.limit.energy_error;
  options.history = scene.output.history;
  options.fields = scene.output.fields;
  options.pressure = scene.output.pressure;
  options.most_steps = scene.limit.steps;
  options.on_plan = hooks.on_plan;
  options.checkpoint = {.file = scene.check_only ? "" : checkpoint_file(scene),
                        .every = scene.checkpoint.every,
                        .at_end = scene.checkpoint.at_end,
                        .stop_file = scene.output.dir + "/STOP",
                        .restart = scene.checkpoint.restart,
                        .lattice = hooks.lattice_id,
                        .obstacles = fingerprint(scene.obstacles) + hooks.program,
                        .tables = fingerprints(scene.tables),
                        .options = scene.options_yaml,
                        .scene = scene.path,
                        .wall_time = scene.checkpoint.wall_time,
                        .wants_pause = hooks.wants_pause,
                        .prepare = hooks.prepare,
                        .others = hooks.others};
  if constexpr (std::is_same_v<Space, Spatial>) {
    if (scene.integrator == Integrator::implicit)
      return make_implicit_run(model, options, std::move(observer));
  }
  if (scene.forces.contact) options.balance = hooks.balance;
  options.supply = hooks.supply;
  options.remake = hooks.remake;
  options.safety = scene.time.safety;
  options.allow_unstable = scene.time.allow_unstable;
  options.backend = scene.backend;
  return make_explicit_run(model, options, std::move(observer));
}

template std::unique_ptr<Run> make_run(const Scene&, Model<Spatial>&, const OutOfPlane*,
                                       const RunHooks&, Observer<Spatial>);
template std::unique_ptr<Run> make_run(const Scene&, Model<Planar>&, const OutOfPlane*,
                                       const RunHooks&, Observer<Planar>);

}  // namespace floe
