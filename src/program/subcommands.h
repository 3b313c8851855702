/// \file
/// The tools that floe runs as subcommands: floe plot_load out/ice_slope.
#pragma once

#include <span>
#include <string_view>

namespace floe::program {

struct Subcommand {
  std::string_view name;
  std::string_view line;  ///< what it does, as floe help lists it
};

/// All of them: each is a program of that name in tools/.
std::span<const Subcommand> subcommands();

/// Whether a tool has this name.
bool is_subcommand(std::string_view word);

/// Becomes the tool, with the words after it. \param argv  words of the tool, its name first, ended
/// by a null pointer \return an exit code, after one line on standard error, if it cannot
int run_subcommand(char** argv);

}  // namespace floe::program
