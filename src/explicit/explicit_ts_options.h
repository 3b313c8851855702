/// \file
/// What of PETSc's options of TS explicit dynamics takes.
#pragma once

#include <string>

namespace floe {

/// The stepper's type: `leapfrog`, or what -ts_type says. \throws InputError for options of solvers
/// (-snes_*, -ksp_*, -pc_*, -mat_*), types that cannot step the bodies of a scene, and options of
/// TS that would have no effect, naming the option and the reason
std::string explicit_type();

}  // namespace floe
