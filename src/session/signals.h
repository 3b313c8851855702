/// \file
/// Requests of users and batch systems to stop a run.
#pragma once

#include <mpi.h>

#include "floe/base/petsc.h"

namespace floe {

/// A run was stopped before it had a state worth keeping. Raised on all ranks alike.
class Stopped : public Verdict {
 public:
  using Verdict::Verdict;
};

/// While an object of this class lives, signals request a stop instead of ending the process:
/// SIGTERM, SIGINT, SIGHUP, SIGUSR1, SIGUSR2 and SIGXCPU, which users and batch systems send before
/// they use force, however often they come. A signal that was ignored when the process began
/// (nohup, a background job of a shell) stays ignored. SIGPIPE and SIGXFSZ are ignored: a closed
/// pipe and a file size limit are reported as errors of the write, and a run goes on when its
/// standard output is closed.
class StopSignals {
 public:
  StopSignals();
  ~StopSignals();
  /// Installs the handlers again, after PetscInitialize has installed its own.
  void arm();
  StopSignals(const StopSignals&) = delete;
  StopSignals& operator=(const StopSignals&) = delete;
  /// Whether a signal has come on this rank.
  static bool came();
  /// Whether a signal has come on any rank. Collective.
  static bool came(MPI_Comm comm);
};

/// Throws if a signal has come before the first state. Collective.
/// \throws Stopped if a signal has come on any rank
void stop_if_asked(MPI_Comm comm);

}  // namespace floe
