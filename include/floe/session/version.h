/// \file
/// The versions of floe and of the libraries at run time.
#pragma once

#include <mpi.h>

#include <string>

namespace floe {

/// Returns the version of floe, for example "0.1.0".
std::string version();

/// Returns the processors for which this library is compiled: the level of x86-64 (x86-64,
/// x86-64-v2, -v3, -v4) or another architecture, and the compiler's -march if it differs, as in
/// "x86-64-v4 (-march=native)". Results of libraries for different processors differ by rounding.
std::string built_for();
/// As above for all ranks: "x86-64-v3 on 2 ranks, x86-64-v4 on 1 rank" if they differ. On each
/// machine the loader takes the best library that the processor supports. Collective.
std::string built_for(MPI_Comm comm);

/// Returns the version of floe, the processors of the build, then one line per library with the
/// version found at run time. May be called before MPI_Init and PetscInitialize.
std::string version_text();

}  // namespace floe
