/// \file
/// Options for PETSc from the environment: the variable PETSC_OPTIONS and the files ~/.petscrc,
/// ./.petscrc and ./petscrc. PETSc would read them without a check and let them change keys of a
/// scene. Session therefore switches that off, and this file reads them.
#pragma once

#include "floe/base/petsc.h"
#include "floe/options/given.h"

namespace floe {

/// Reads all options of the environment on rank 0 for all ranks, whether or not floe takes them
/// (Options decides). Collective. Lines that are not options are left out.
/// \param petscrc  whether to read the files as well as the variable
GivenOptions read_environment(bool petscrc, MPI_Comm comm = MPI_COMM_WORLD);

/// Reads the text of one petscrc file: one option per line, "-name value"; "#" begins a comment.
/// \param place  name of the file, for messages
GivenOptions parse_petscrc(const std::string& text, const std::string& place);

/// Reads a text such as PETSC_OPTIONS: "-name value -name ..."; quoted values may hold blanks.
/// \param place  source of the text, for messages
GivenOptions parse_petsc_options(const std::string& text, const std::string& place);

}  // namespace floe
