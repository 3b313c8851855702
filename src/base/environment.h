/// \file
/// Options for PETSc that lie around: in the variable PETSC_OPTIONS and in the files ~/.petscrc,
/// ./.petscrc and ./petscrc. PETSc would read them before anybody can look at them, and would let
/// them change keys of a scene; so it is told not to, and they are read here.
#pragma once

#include "floe/base/given.h"
#include "floe/base/petsc.h"

namespace floe {

/// Everything that the environment gives, whether floe takes it or not (Options says which); rank
/// 0's for all ranks. Collective. Lines that are no options are left out.
/// \param petscrc  whether the files are read, beside the variable
GivenOptions read_environment(bool petscrc, MPI_Comm comm = MPI_COMM_WORLD);

/// The options of one petscrc file's text: one a line, "-name value", "#" begins a comment.
GivenOptions parse_petscrc(const std::string& text, const std::string& place);

/// The options of a text like the one of PETSC_OPTIONS: "-name value -name ...", values in quotes
/// may hold blanks.
GivenOptions parse_petsc_options(const std::string& text, const std::string& place);

}  // namespace floe
