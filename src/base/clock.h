/// \file
/// How long this process has been running.
#pragma once

namespace floe {

/// Time by the clock since the process began [s].
double seconds_of_process();

}  // namespace floe
