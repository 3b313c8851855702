/// \file
/// The command line: "floe SCENE.yaml -key value ...".
#pragma once

#include <string>

#include "floe/base/given.h"

namespace floe {

/// What the command line asks to be printed instead of a run.
struct Help {
  enum Kind { none, text, markdown };
  Kind kind = none;
  std::string topic;  ///< "floe -help sheet": one section or key only; empty: all
};

/// Looks for -help and -help_markdown anywhere on the command line; needs no scene.
/// The word after it, if it is no option, is the topic.
Help wants_help(int argc, const char* const* argv);

/// What the words of a command line say.
struct CommandLine {
  std::string scene;     ///< path: the first word; empty: -checkpoint_restart says it
  GivenOptions options;  ///< of several values for one name the last
  bool petscrc = true;   ///< petscrc files are read; not with -skip_petscrc
};

/// \throws InputError if the scene is missing and no -checkpoint_restart is given, or for stray
/// words, --key, -key=value, and what PETSc would take from elsewhere (-options_file and its kin).
CommandLine read_command_line(int argc, const char* const* argv);

}  // namespace floe
