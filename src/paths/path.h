/// \file
/// Static runs along an equilibrium path, past limit points of the load.
#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "run/integrator.h"
#include "run/run.h"
#include "statics/quasistatic.h"

namespace floe {

/// A displacement at which a path may end.
template <class Space>
struct PathEnd {
  std::function<double(const State<Space>&)> displacement;  ///< collective [m]
  double value = 0;                                         ///< [m]
};

/// Settings of a run along a path.
template <class Space>
struct PathOptions {
  double full_time = 1;       ///< pseudo-time at which loads and motions have the load factor 1 [s]
  double arc = 0;             ///< arc length of the first step [m]; 0: chosen
  double arc_min = 0;         ///< the run ends where a shorter one would be needed [m]; 0: arc/4096
  double arc_max = 0;         ///< [m]; 0: a twentieth of the lattice's extent
  double growth = 0.05;       ///< of s in a step of softening
  std::int64_t steps = 1000;  ///< most steps
  std::optional<double> load_factor;       ///< the path ends there
  std::optional<PathEnd<Space>> ends_at;   ///< or there
  double most_steps = default_most_steps;  ///< a run of more steps is refused
  OnPlan on_plan = nullptr;
};

/// Makes a run that follows the equilibria of a model from the load factor 0 on, step by step, with
/// the load factor as an unknown (PathEquilibrium). The time of its states is the number of the
/// step. Loads and motions must be linear in the pseudo-time (Ramp::endless). Collective.
/// \param rest  as for make_quasistatic_run
template <class Space>
std::unique_ptr<Run> make_path_run(Model<Space>& model, PathOptions<Space> options,
                                   ObserverOf<Space> observer, const OutOfPlane* rest = nullptr);

}  // namespace floe
