/// \file
/// Search for the checkpoint of a restart, before the scene is read (docs/restarts.md).
#pragma once

#include <string>
#include <vector>

#include "floe/base/petsc.h"
#include "floe/options/given.h"

namespace floe {

/// Result of the search for `checkpoint: restart`.
struct Restart {
  std::string file;   ///< checkpoint to go on from; empty: none
  std::string scene;  ///< path of the scene's file: the given one, else the checkpoint's
  std::string run;    ///< identifier of the run; empty: none
  double time = 0;    ///< time of the checkpoint [s]
  /// With `auto`: the folder whose run is done already; empty if it is not done.
  std::string done_in;
  double done_end = 0;  ///< time: end of that run [s]
  std::vector<std::string> remarks;
};

/// Finds the checkpoint that the scene or the command line names, or with `auto` the newest good
/// one of the output folder, and checks it. Stores the options of its run in user.checkpoint, and
/// its path in place of `auto`; `auto` stays if there is no checkpoint. Collective, before Session.
/// \param scene  path of the scene's file; empty: all options are the checkpoint's
/// \throws InputError for a damaged checkpoint, naming the generation before it if that is good;
///   with `auto` if there are checkpoints and none is good
Restart find_restart(const std::string& scene, UserOptions& user, MPI_Comm comm = MPI_COMM_WORLD);

}  // namespace floe
