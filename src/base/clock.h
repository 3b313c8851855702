/// \file
/// The running time of this process.
#pragma once

namespace floe {

/// Returns the wall time since the process began [s].
double seconds_of_process();

}  // namespace floe
