/// \file
/// What Open MPI is told before it begins.
#pragma once

namespace floe {

/// Tells Open MPI what one process does without; what the user has set stands, but for the
/// yielding. Before MPI_Init.
void prepare_one_process();

}  // namespace floe
