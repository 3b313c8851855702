/// \file
/// Runs that halt within a launch, because of what the host must see to before they go on.
#pragma once

#include <cstdint>

#include "device/engine.h"
#include "device/launch.h"

namespace floe::device {
namespace {  // of each back end its own, as in launch.h

/// Per run. All tiles of a run complete the step at which it halts; then its bodies stay.
struct Halts {
  std::int32_t* last;  ///< the last step of this launch that it makes
  std::uint32_t* why;  ///< bits of Made::Why

  /// Whether a run stands still in a step.
  constexpr bool stands(std::int32_t run, int step) const { return step > last[run]; }
  /// Lets a run halt at a step that it makes.
  FLOE_KERNEL void halt(std::int32_t run, int step, Made::Why reason) const {
    lower(&last[run], step);
    add_bits(&why[run], reason);
  }
};

}  // namespace
}  // namespace floe::device
