/// \file
/// Runs of run_explicit in process.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include "stability/stable_step.h"
#include "support/dynamics.h"

namespace floe::test {

/// How a run ended.
struct ExplicitRun {
  RunResult result;
  State<Spatial> state;                   ///< the last one
  std::map<std::string, double> columns;  ///< the integrator's and the forces' of the last sample
  double largest_balance_error = 0;       ///< of all samples [J]
};

/// A scene from 0 to its time: end, on one process. \param samples  beside the first
inline ExplicitRun run_scene(const Scene& scene, const Lattice& lattice, double dt,
                             int samples = 1) {
  Model<Spatial> model(lattice, PETSC_COMM_SELF, scene.boundaries);
  add_forces(scene, place_loads(scene, lattice), model, &lattice);
  ExplicitOptions options;
  options.end = scene.time.end;
  options.dt = dt;
  options.history = scene.time.end / samples;
  options.allow_unstable = scene.time.allow_unstable;
  options.velocity_limit = scene.limit.velocity;
  options.energy_limit = scene.limit.energy_error;
  ExplicitRun run;
  run.result = run_explicit(model, options, [&](const Accepted<Spatial>& accepted) {
    run.state = accepted.state;
    run.columns.clear();
    for (const auto& [name, value] : accepted.forces) run.columns[name] = value;
    for (const auto& [name, value] : accepted.columns) run.columns[name] = value;
    run.largest_balance_error =
        std::max(run.largest_balance_error, std::abs(run.columns["energy_balance_error"]));
  });
  return run;
}

/// Leapfrog's stable step of a scene at rest.
inline double stable_of(const Scene& scene, const Lattice& lattice) {
  Dynamics at_rest(scene, lattice);
  return stable_step(at_rest.model(), at_rest.state()).dt;
}

}  // namespace floe::test
