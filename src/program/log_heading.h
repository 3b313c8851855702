/// \file
/// The first lines of a run's log file.
#pragma once

#include <string>

namespace floe::program {

/// Returns version, date, command line, folder, machine, number of ranks and the processors for
/// which the library is built. To be called after MPI has begun.
std::string log_heading(int argc, const char* const* argv);

}  // namespace floe::program
