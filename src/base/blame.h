/// \file
/// Which of the options of PETSc's that a run was given an error of PETSc's is about.
#pragma once

#include <string>

#include "floe/base/given.h"

namespace floe {

/// The options of PETSc's that a run was given. Until they have proved good, an error of PETSc's is
/// taken to be theirs (see fail()).
void set_solver_options(GivenOptions given);
/// A first solve has used them all.
void solver_options_are_good();
/// Whether an error of PETSc's at present is likely to be about an option.
bool solver_options_are_doubtful();

/// The option that an error names, or whose value it names, or all that were given, and PETSc's
/// words, in one line.
std::string blame_solver_options(const std::string& petsc_says);
/// The option that an error names, as "-NAME VALUE"; empty if it names none.
std::string solver_option_named(const std::string& petsc_says);

/// What to say of a crash while options are doubtful; empty: they are not. Takes no memory.
const char* blame_for_a_crash();

}  // namespace floe
