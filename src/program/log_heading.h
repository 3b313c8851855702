/// \file
/// The first lines of a run's log file.
#pragma once

#include <string>

namespace floe::program {

/// Version, date, command line, folder, machine, number of ranks and the processors that the
/// library is built for. After MPI has begun.
std::string log_heading(int argc, const char* const* argv);

}  // namespace floe::program
