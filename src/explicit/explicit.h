/// \file
/// Explicit dynamics.
#pragma once

#include <string>

#include "run/integrator.h"

namespace floe {

/// What explicit dynamics is told.
struct ExplicitOptions : DynamicOptions {
  double safety = 0.9;          ///< dt = 0: this part of the stable step
  bool allow_unstable = false;  ///< take a given dt above the stable step
};

/// Newton's equations by PETSc's TS: own type `leapfrog`, velocities half a step behind. Every
/// sample goes to the observer. Stops, with the last sample as last good state, when a velocity or
/// the energy balance crosses its limit or a number is not finite. Collective. \throws InputError
/// for a dt above the stable step, and for options of solvers that explicit dynamics does not use
template <class Space>
RunResult run_explicit(Model<Space>& model, const ExplicitOptions& options,
                       const ObserverOf<Space>& observer);

/// Why the stepper that the options choose takes spatial models only; empty if it does not.
std::string explicit_needs_space();

}  // namespace floe
