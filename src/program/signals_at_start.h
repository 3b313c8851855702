/// \file
/// Signals as they were when the process began, before any library was loaded.
#pragma once

namespace floe::program {

/// Gives SIGHUP back the disposition that it had then (ignored under nohup): UCX, under Open MPI,
/// takes it when it is loaded. One that came in between is delivered now.
void restore_signals();

}  // namespace floe::program
