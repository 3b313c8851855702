/// \file
/// Settings of Open MPI that must precede MPI_Init, and of the system.
#pragma once

namespace floe {

/// Switches off the parts of Open MPI that one process does not need. Settings of the user are
/// kept, except for yielding when idle. Call before MPI_Init.
void prepare_one_process();

/// Asks Linux to let this process run often and briefly rather than seldom and long, its share of
/// the processor being the same. Ranks that wait for each other need many turns: beside 10 busy
/// processes a message else takes tens of milliseconds. Kernels before 6.12 take no notice.
void ask_for_short_turns();

}  // namespace floe
