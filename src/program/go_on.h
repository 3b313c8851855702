/// \file
/// The command that goes on where a run has stopped.
#pragma once

#include <string>
#include <vector>

namespace floe::program {

using Words = std::vector<std::string>;

/// One line for a shell: mpiexec where several ranks ran, the program and its scene as they were
/// called, the checkpoint, and all other options, but for those that would begin anew.
/// \param words  of the command, the program's name first
std::string command_to_go_on(const Words& words, const std::string& checkpoint, int ranks);

}  // namespace floe::program
