/// \file
/// Implicit dynamics.
#pragma once

#include "run/integrator.h"

namespace floe {

/// Newton's equations by PETSc's TS: own type `liealpha`, generalised-alpha on the rotation group,
/// with the exact tangent; any step. All of PETSc's -ts_adapt_*, -snes_*, -ksp_*, -pc_* and -mat_*
/// options apply. The given step is taken throughout (cut where Newton fails), without one steps
/// adapt to the error. Samples as run_explicit; where times between them are given, steps end
/// there. Collective. \throws InputError for a force with history and for another -ts_type
RunResult run_implicit(Model<Spatial>& model, const DynamicOptions& options,
                       const Observer<Spatial>& observer);

}  // namespace floe
