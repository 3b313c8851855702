/// \file
/// Settings of Open MPI that must precede MPI_Init.
#pragma once

namespace floe {

/// Switches off the parts of Open MPI that one process does not need. Settings of the user are
/// kept, except for yielding when idle. Call before MPI_Init.
void prepare_one_process();

}  // namespace floe
