/// \file
/// PETSc TS type `leapfrog`: the default of explicit dynamics, at the cost of a bare loop (own type
/// because PETSc's explicit types move whole vectors about several times a step).
#pragma once

#include <petscts.h>

#include <functional>

#include "floe/base/petsc.h"

namespace floe {

/// One step of `dt` from the time that the stepper itself keeps; false stops the run.
using LeapfrogStep = std::function<bool(double dt)>;

inline constexpr const char* ts_leapfrog = "leapfrog";

/// Makes the type known to PETSc (once).
void register_leapfrog();

/// The work that a TS of this type does each step. \param step must outlive the TS
void set_leapfrog_step(TS ts, LeapfrogStep* step);

}  // namespace floe
