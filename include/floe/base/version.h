/// \file
/// What a run rests on: floe's version and those of the libraries that it runs with.
#pragma once

#include <mpi.h>

#include <string>

namespace floe {

/// Version of floe, as "0.1.0".
std::string version();

/// Which processors this library is compiled for: the level of x86-64 (x86-64, x86-64-v2, -v3, -v4)
/// or another architecture, and the compiler's -march where that says something else, as in
/// "x86-64-v4 (-march=native)". Results of libraries for different processors differ by rounding.
std::string built_for();
/// The same for all ranks, as "x86-64-v3 on 2 ranks, x86-64-v4 on 1 rank" where they differ (the
/// loader takes on each machine the best library that its processor can run). Collective.
std::string built_for(MPI_Comm comm);

/// Version of floe, what it is built for, then one line per library, as it is found at run time.
/// Needs neither MPI nor PETSc to have begun.
std::string version_text();

}  // namespace floe
