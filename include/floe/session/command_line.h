/// \file
/// The command line: "floe SCENE.yaml -key value ...".
#pragma once

#include <functional>
#include <string>

#include "floe/options/given.h"

namespace floe {

/// The help text that a command line requests instead of a run.
struct Help {
  enum Kind { none, text, markdown };
  Kind kind = none;
  std::string topic;  ///< "floe -help sheet": the section or key to print; empty: all options
};

/// Searches the whole command line for -help and -help_markdown; a scene is not needed. The word
/// after -help is the topic unless it is an option.
Help wants_help(int argc, const char* const* argv);

/// The contents of a parsed command line.
struct CommandLine {
  std::string scene;     ///< path, the first word; empty if -checkpoint_restart names the run
  GivenOptions options;  ///< options by name; the last value of a repeated name is kept
  bool petscrc = true;   ///< whether petscrc files are read; -skip_petscrc sets false
};

/// Parses the command line.
/// \throws InputError if the scene is missing and no -checkpoint_restart is given, and for stray
/// words, --key, -key=value, and options with which PETSc would read further options from a file or
/// a string (-options_file and similar).
CommandLine read_command_line(int argc, const char* const* argv);

/// Collects the options of a run: those of the environment, of the scene's file and of the command
/// line. Collective, after Mpi and before Session.
/// \param near_to  returns words for the message if the scene does not exist, for example a similar
///   name
/// \throws InputError if the scene cannot be read
UserOptions options_of(const CommandLine& line,
                       const std::function<std::string(const std::string&)>& near_to = {});

/// As options_of(), for a scene that is a text instead of a file. Messages name no lines.
/// \param name  of the scene, for messages
/// \throws InputError as options_of()
UserOptions options_of_text(const CommandLine& line, const std::string& name,
                            const std::string& text);

}  // namespace floe
