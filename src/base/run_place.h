/// \file
/// How far a run has got, for what is said of a crash.
#pragma once

#include <cstdint>

namespace floe {

/// Plain values, which a handler of a signal may read.
struct RunPlace {
  const char* stage = "at the start";  ///< of static life
  double time = 0;                     ///< [s]
  std::int64_t step = -1;              ///< the last that is done; < 0: none
  int code = 0;                        ///< the exit code, when the process ends by itself
};

/// That of this process.
RunPlace& run_place();

}  // namespace floe
