/// \file
/// What of PETSc's options explicit dynamics does not take.
#pragma once

namespace floe {

/// Options of solvers (-snes_*, -ksp_*, -pc_*, -mat_*) and stepper types that cannot step the
/// bodies of a scene. \throws InputError naming the option and the reason
void refuse_options_of_others();

}  // namespace floe
