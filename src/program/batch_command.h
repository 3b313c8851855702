/// \file
/// The command of floe ensemble that makes the steps of many runs together.
#pragma once

namespace floe::program {

/// Serves the runs of a batch until all have ended, then prints how many launches it made:
/// floe -batch BACKEND FILE..., where BACKEND is loop or cuda and each FILE the number of an open
/// connection to a run. \return an exit code
int serve_batch(int argc, char** argv);

}  // namespace floe::program
