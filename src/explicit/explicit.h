/// \file
/// Explicit dynamics (model.md, "Explicit dynamics").
#pragma once

#include <memory>
#include <string>

#include "floe/explicit/backend.h"
#include "run/integrator.h"
#include "run/run.h"

namespace floe {

/// Settings of explicit dynamics.
struct ExplicitOptions : DynamicOptions {
  double safety = 0.9;          ///< with dt = 0: the step as a part of the stable step
  bool allow_unstable = false;  ///< accept a given dt above the stable step
  Backend backend = Backend::cpu;
};

/// Makes a run that integrates Newton's equations by PETSc's TS, of the own type `leapfrog`
/// (velocities half a step behind) or `rk`. Every sample goes to the observer. Stops, with the last
/// sample as the last good state, when a velocity or the energy balance crosses its limit or a
/// number is not finite. Collective. \throws InputError for a dt above the stable step, and for
/// options of solvers that explicit
///   dynamics does not use
template <class Space>
std::unique_ptr<Run> make_explicit_run(Model<Space>& model, const ExplicitOptions& options,
                                       ObserverOf<Space> observer);

/// Makes the whole run. Collective. \throws InputError as make_explicit_run()
template <class Space>
RunResult run_explicit(Model<Space>& model, const ExplicitOptions& options,
                       ObserverOf<Space> observer) {
  return run_to_end(*make_explicit_run(model, options, std::move(observer)));
}

/// Returns why the chosen stepper takes spatial models only; empty if it takes planar models too.
std::string explicit_needs_space(Backend backend);

}  // namespace floe
