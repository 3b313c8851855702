/// \file
/// What of PETSc's options of TS implicit dynamics takes.
#pragma once

namespace floe {

/// \throws InputError for an -ts_type other than `liealpha` and for options of TS that would upset
/// samples and checkpoints, naming the option and the reason
void check_implicit_options();

}  // namespace floe
