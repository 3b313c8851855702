/// \file
/// Uses of the command line other than the run of a scene: help, versions, tools.
#pragma once

#include <optional>
#include <string>

#include "floe/session/command_line.h"

namespace floe::program {

/// Exit codes. bad_input is for floe::InputError, stopped for a run that stopped on request and
/// wrote a checkpoint.
enum Exit { done = 0, failed = 1, bad_input = 2, stopped = 3 };

/// Handles all commands that need no run, before MPI begins.
/// \return the exit code; nothing if a scene is to be run. A first word is a scene if it is a file,
///   has '/' or '.' in it, or is not known.
std::optional<int> answer(int argc, char** argv);

/// Prints the options of scenes, all or those of a topic. \return the exit code
int print_options(const Help& help);

/// Returns a hint for a scene that does not exist: a similar name, or an empty string.
std::string near_scene(const std::string& scene);

/// Whether this process is the launcher's first one, and how many it started. Both are known from
/// the environment before MPI begins (OpenMPI's, PMIx's, MPICH's); true and 1 without a launcher.
bool is_first_rank();
int ranks_of_launcher();

}  // namespace floe::program
