/// \file
/// Requests to stop that come from outside.
#pragma once

#include <mpi.h>

#include "floe/base/petsc.h"

namespace floe {

/// A run was asked to stop where it has nothing to keep yet. Raised alike on all ranks.
class Stopped : public Verdict {
 public:
  using Verdict::Verdict;
};

/// While this lives, signals ask for a stop instead of ending the process: those that users and
/// batch systems send before they use force (SIGTERM, SIGINT, SIGHUP, SIGUSR1, SIGUSR2, SIGXCPU),
/// however often they come. One that was ignored when the process began (nohup, a shell's
/// background job) still is. A closed pipe and a file size limit are errors of the write; a closed
/// standard output is nothing that a run minds.
class StopSignals {
 public:
  StopSignals();
  ~StopSignals();
  /// Again, after PETSc has begun and installed handlers of its own.
  void arm();
  StopSignals(const StopSignals&) = delete;
  StopSignals& operator=(const StopSignals&) = delete;
  /// Whether one came on this rank.
  static bool came();
  /// Whether one came on any rank. Collective.
  static bool came(MPI_Comm comm);
};

/// \throws Stopped if a signal has come on any rank. Collective; for what happens before the first
/// state.
void stop_if_asked(MPI_Comm comm);

}  // namespace floe
