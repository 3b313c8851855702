/// \file
/// Signals that were ignored when the process began (nohup), before any library was loaded.
#pragma once

#include <cstdint>

namespace floe::program {

/// A bit per signal, that of signal k being 1 << k. Libraries may have taken a signal since: UCX,
/// under Open MPI, takes SIGHUP when it is loaded.
std::uint64_t ignored_at_start();

}  // namespace floe::program
