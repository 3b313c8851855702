/// \file
/// Implicit dynamics (model.md, "Implicit dynamics").
#pragma once

#include <memory>
#include <utility>

#include "run/integrator.h"
#include "run/run.h"

namespace floe {

/// Makes a run that integrates Newton's equations by PETSc's TS, of the own type `liealpha`:
/// generalised-alpha on the rotation group with the exact tangent, stable at any step. All of
/// PETSc's -ts_adapt_*, -snes_*, -ksp_*, -pc_* and -mat_* options apply. A given step is used
/// throughout (cut where Newton fails); without one steps adapt to the error. Samples are as in
/// run_explicit; where times between samples are given, steps end there. Collective. \throws
/// InputError for a force with history and for another -ts_type
std::unique_ptr<Run> make_implicit_run(Model<Spatial>& model, const DynamicOptions& options,
                                       Observer<Spatial> observer);

/// Makes the whole run. Collective. \throws InputError as make_implicit_run()
inline RunResult run_implicit(Model<Spatial>& model, const DynamicOptions& options,
                              Observer<Spatial> observer) {
  return run_to_end(*make_implicit_run(model, options, std::move(observer)));
}

}  // namespace floe
