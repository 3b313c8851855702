/// \file
/// What the types of explicit dynamics share beside DynamicRun.
#pragma once

#include "floe/solve/integrator.h"
#include "solve/stable_step.h"

namespace floe {

/// The step to take: the given one, else `safety` of the stable one. \param given  0: none
/// \throws InputError for a given step above the stable one that was not asked for all the same,
/// and if neither says anything
double wanted_step(const ExplicitOptions& options, double given, const StableStep& stable);

/// Newton's equations by PETSc's explicit Runge-Kutta methods, all of their -ts_rk_type, on bodies'
/// records as vectors; the step fixed, or PETSc's -ts_adapt_type basic. \throws InputError
RunResult run_rk(Model<Spatial>& model, const ExplicitOptions& options,
                 const Observer<Spatial>& observer);

}  // namespace floe
