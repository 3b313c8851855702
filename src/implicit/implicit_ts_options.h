/// \file
/// PETSc options of TS that implicit dynamics takes.
#pragma once

namespace floe {

/// Checks the options of TS.
/// \throws InputError for a -ts_type other than `liealpha` and for options of TS that would upset
///   samples and checkpoints, naming the option and the reason
void check_implicit_options();

}  // namespace floe
