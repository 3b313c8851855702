/// \file
/// The assignment of an error of PETSc to the option that caused the error.
#pragma once

#include <string>

#include "floe/options/given.h"

namespace floe {

/// Sets the options of PETSc that the run was given. Until they are known to be good, an error of
/// PETSc is attributed to them (see fail()).
void set_solver_options(GivenOptions given);
/// Marks the options as good: a first solve has used all of them.
void solver_options_are_good();
/// Whether a present error of PETSc is probably caused by an option.
bool solver_options_are_doubtful();

/// Returns one line with PETSc's message, preceded by the option that the message names, or whose
/// value the message names, or by all given options.
std::string blame_solver_options(const std::string& petsc_says);
/// Returns the option that PETSc's message names, as "-NAME VALUE"; empty if there is none.
std::string solver_option_named(const std::string& petsc_says);

/// Returns the message for a crash while options are doubtful; empty if no option is doubtful.
/// Allocates no memory.
const char* blame_for_a_crash();

}  // namespace floe
