/// \file
/// What a run rests on: floe's version and those of the libraries that it runs with.
#pragma once

#include <string>

namespace floe {

/// Version of floe, as "0.1.0".
std::string version();

/// Version of floe, then one line per library, as it is found at run time. Needs neither MPI nor
/// PETSc to have begun.
std::string version_text();

}  // namespace floe
