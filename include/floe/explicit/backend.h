/// \file
/// What makes the steps of explicit dynamics.
#pragma once

namespace floe {

enum class Backend {
  cpu,   ///< the loops of the processor, for all forces
  loop,  ///< the text of devices, in loops on the processor: for tests
  cuda,  ///< a device of NVIDIA
};

/// Returns the name of a back end in scenes.
constexpr const char* name_of(Backend backend) {
  return backend == Backend::loop ? "loop" : backend == Backend::cuda ? "cuda" : "cpu";
}

}  // namespace floe
