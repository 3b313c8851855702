/// \file
/// Runs of run_implicit in process.
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Core>

#include <map>
#include <string>
#include <vector>

#include "implicit/implicit.h"
#include "scene_model/scene_model.h"
#include "support/static_solution.h"

namespace floe::test {

/// How a run ended, on one process.
struct ImplicitRun {
  RunResult result;
  State<Spatial> state;                   ///< the last one
  std::map<std::string, double> columns;  ///< the integrator's and the forces' of the last sample
  std::vector<double> times;              ///< of all samples
};

/// A scene from 0 to its time: end. \param dt  0: adaptive   \param change  more of the options
inline ImplicitRun run_implicitly(
    const Scene& scene, const Lattice& lattice, double dt,
    const std::function<void(DynamicOptions&)>& change = [](DynamicOptions&) {}) {
  Model<Spatial> model(lattice, PETSC_COMM_SELF, scene.boundaries);
  add_forces(scene, place_loads(scene, lattice), model, &lattice);
  DynamicOptions options;
  options.end = scene.time.end;
  options.dt = dt;
  options.velocity_limit = scene.limit.velocity;
  options.energy_limit = scene.limit.energy_error;
  change(options);
  ImplicitRun run;
  run.result = run_implicit(model, options, [&](const Accepted<Spatial>& accepted) {
    run.state = accepted.state;
    run.times.push_back(accepted.state.time);
    run.columns.clear();
    for (const auto& [name, value] : accepted.forces) run.columns[name] = value;
    for (const auto& [name, value] : accepted.columns) run.columns[name] = value;
  });
  return run;
}

/// Displacements and rotations of all bodies, quaternions with w >= 0.
inline Eigen::VectorXd configuration(const State<Spatial>& state) {
  const std::size_t bodies = state.records.size() / Spatial::record;
  Eigen::VectorXd all(7 * static_cast<Eigen::Index>(bodies));
  for (std::size_t b = 0; b < bodies; ++b) {
    const auto at = 7 * static_cast<Eigen::Index>(b);
    const double* r = state.record(b);
    const double sign = r[Spatial::rotation] < 0 ? -1 : 1;
    for (Eigen::Index k = 0; k < 7; ++k) all[at + k] = (k < 3 ? 1 : sign) * r[k];
  }
  return all;
}

inline PetscOption radius(double value) { return {"-ts_liealpha_radius", std::to_string(value)}; }

}  // namespace floe::test
