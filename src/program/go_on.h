/// \file
/// The command that goes on after a run has stopped.
#pragma once

#include <string>
#include <vector>

namespace floe::program {

using Words = std::vector<std::string>;

/// Quotes a word for a shell, if that is needed.
std::string shell_word(const std::string& word);

/// Returns a line for a shell: mpiexec for several ranks, the program and its scene as they were
/// called, the checkpoint, and all other options except those that would begin anew.
/// \param words  words of the command, the program's name first
std::string command_to_go_on(const Words& words, const std::string& checkpoint, int ranks);

}  // namespace floe::program
