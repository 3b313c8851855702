/// \file
/// What the command line asks for beside the run of a scene: help, versions, tools.
#pragma once

#include <optional>
#include <string>

namespace floe::program {

/// What a shell sees. bad_input is floe::InputError; stopped: on request, a checkpoint has been
/// written.
enum Exit { done = 0, failed = 1, bad_input = 2, stopped = 3 };

/// Answers what needs no run, before MPI begins. \return the exit code; nothing if a scene is to be
/// run, which a first word is that is a file or has '/' or '.' in it, and every word not known
std::optional<int> answer(int argc, char** argv);

/// Words that help whoever named a scene that is not there: a similar name, or nothing.
std::string near_scene(const std::string& scene);

/// Whether the launcher calls this process the first one, and how many it started: known from its
/// environment before MPI begins (OpenMPI's, PMIx's, MPICH's); true and 1 without one.
bool is_first_rank();
int ranks_of_launcher();

}  // namespace floe::program
