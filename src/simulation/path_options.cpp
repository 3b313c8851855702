#include "simulation/path_options.h"

#include <utility>

#include "base/collectives.h"

namespace floe {
namespace {

/// A component of the mean displacement of bodies, with their turned arms.
template <class Space>
struct MonitoredDisplacement {
  const Model<Space>& model;
  std::vector<std::int32_t> bodies;  ///< owned, local
  double count;                      ///< of all ranks
  Vec3<double> arm;                  ///< from the centroid, at rest [m]
  int component;

  double operator()(const State<Space>& state) const {
    double sum = 0;
    for (const std::int32_t body : bodies) {
      const auto b = static_cast<std::size_t>(body);
      const bool linear = model.kinematics() == Kinematics::linear;
      const Vec3<double> turn =
          linear ? cross(linear_rotation(state, b), arm) : rotate(rotation(state, b), arm) - arm;
      sum += (displacement(state, b) + turn)[static_cast<std::size_t>(component)];
    }
    return sum_over_ranks(sum, model.part().comm) / count;
  }
};

}  // namespace

template <class Space>
PathOptions<Space> path_options(const Scene& scene, const Model<Space>& model,
                                const RunHooks& hooks) {
  const auto& given = scene.path_control;
  PathOptions<Space> options;
  options.full_time = scene.time.end;
  options.arc = given.arc_length;
  options.arc_min = given.arc_length_min;
  options.arc_max = given.arc_length_max;
  options.growth = given.growth;
  options.steps = given.steps;
  options.load_factor = given.load_factor;
  options.most_steps = scene.limit.steps;
  options.on_plan = hooks.on_plan;
  if (given.monitor.empty()) return options;
  const Part& part = model.part();
  MonitoredDisplacement<Space> monitor{model, {}, 0, {}, given.component};
  for (const PlacedBoundary& placed : model.boundaries()) {
    if (placed.boundary.name != given.monitor) continue;
    for (const std::int32_t body : placed.bodies) {
      if (body < part.owned) monitor.bodies.push_back(body);
    }
  }
  for (const PlacedLoad& placed : *hooks.loads) {
    if (placed.load.name != given.monitor) continue;
    monitor.arm = placed.arm;
    for (const std::int32_t body : placed.bodies) {
      const std::int32_t local = part.local_index(body);
      if (local >= 0 && local < part.owned) monitor.bodies.push_back(local);
    }
  }
  monitor.count = sum_over_ranks(static_cast<double>(monitor.bodies.size()), part.comm);
  options.ends_at = PathEnd<Space>{std::move(monitor), given.displacement};
  return options;
}

template PathOptions<Spatial> path_options(const Scene&, const Model<Spatial>&, const RunHooks&);
template PathOptions<Planar> path_options(const Scene&, const Model<Planar>&, const RunHooks&);

}  // namespace floe
