/// \file
/// PETSc TS type `leapfrog`, the default of explicit dynamics. It costs no more than a bare loop;
/// PETSc's explicit types move whole vectors several times a step.
#pragma once

#include <petscts.h>

#include <functional>

#include "floe/base/petsc.h"

namespace floe {

/// Makes one step of `dt` [s] from the time that the stepper keeps itself. False stops the run.
using LeapfrogStep = std::function<bool(double dt)>;

/// Name of the type in PETSc.
inline constexpr const char* ts_leapfrog = "leapfrog";

/// Registers the type with PETSc, once.
void register_leapfrog();

/// Sets the work that a TS of this type does in each step. \param step  must outlive the TS
void set_leapfrog_step(TS ts, LeapfrogStep* step);

}  // namespace floe
