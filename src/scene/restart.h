/// \file
/// Where a run goes on from, found before its scene is read (docs/restarts.md).
#pragma once

#include <string>
#include <vector>

#include "floe/base/given.h"
#include "floe/base/petsc.h"

namespace floe {

/// What `checkpoint: restart` has led to.
struct Restart {
  std::string file;   ///< the checkpoint to go on from; empty: none
  std::string scene;  ///< path of the scene's file: as given, else the checkpoint's
  std::string run;    ///< what identifies the run; empty: nothing
  double time = 0;    ///< of the checkpoint [s]
  /// With `auto`: the folder whose run has come to its end already; empty: it has not.
  std::string done_in;
  double done_end = 0;  ///< its time: end [s]
  std::vector<std::string> remarks;
};

/// Finds the checkpoint that the scene or the command line names, or with `auto` the newest good
/// one of the output folder, and checks it. What its run had goes to user.checkpoint, and its path
/// to where `auto` was; `auto` stays where there is none. Collective, before Session. \param scene
/// path of the scene's file; empty: the checkpoint's options are all \throws InputError for a
/// checkpoint that is damaged, naming the generation before it if that is good; with `auto` if none
/// of those that are there is good
Restart find_restart(const std::string& scene, UserOptions& user, MPI_Comm comm = MPI_COMM_WORLD);

}  // namespace floe
