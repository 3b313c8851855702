/// \file
/// The tools that floe runs as subcommands: floe plot_load out/ice_slope.
#pragma once

#include <span>
#include <string_view>

namespace floe::program {

/// A tool and its description.
struct Subcommand {
  std::string_view name;
  std::string_view line;  ///< description in the list of floe help
};

/// All tools: each is a program of that name in tools/.
std::span<const Subcommand> subcommands();

/// Whether a tool has this name.
bool is_subcommand(std::string_view word);

/// Replaces this process by the tool.
/// \param argv  words of the tool, its name first, ended by a null pointer
/// \return an exit code, after one line on standard error, if the tool cannot be run
int run_subcommand(char** argv);

}  // namespace floe::program
