/// \file
/// What Open MPI and the system are told of this process.
#pragma once

namespace floe {

/// Tells Open MPI what one process does without; what the user has set stands, but for the
/// yielding. Before MPI_Init.
void prepare_one_process();

/// Asks Linux to let this process run often and briefly rather than seldom and long, its share of
/// the processor being the same. Ranks that wait for each other need many turns: beside 10 busy
/// processes a message else takes tens of milliseconds. Kernels before 6.12 take no notice.
void ask_for_short_turns();

}  // namespace floe
