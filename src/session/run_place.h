/// \file
/// The progress of a run, for the message after a crash.
#pragma once

#include <cstdint>

namespace floe {

/// Plain values, which a signal handler may read.
struct RunPlace {
  const char* stage = "at the start";  ///< a string with static lifetime
  double time = 0;                     ///< [s]
  std::int64_t step = -1;              ///< last finished step; < 0: none
  int code = 0;                        ///< exit code of a process that ends by itself
};

/// Returns the progress of this process's run.
RunPlace& run_place();

}  // namespace floe
