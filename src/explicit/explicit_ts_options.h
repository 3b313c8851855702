/// \file
/// PETSc options of TS that explicit dynamics takes.
#pragma once

#include <string>

namespace floe {

/// Returns the type of the stepper: `leapfrog`, or the type that -ts_type gives.
/// \throws InputError for options of solvers (-snes_*, -ksp_*, -pc_*, -mat_*), types that cannot
///   step the bodies of a scene, and options of TS that would have no effect, naming the option and
///   the reason
std::string explicit_type();

}  // namespace floe
