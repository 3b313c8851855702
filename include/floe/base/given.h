/// \file
/// The options that a user gave, as text, before anybody has looked at what they mean: those of
/// floe and of PETSc alike, by the name that they have on the command line.
#pragma once

#include <functional>
#include <map>
#include <string>

namespace floe {

/// Where an option was given; what stands further down wins.
enum class Source {
  environment,   ///< PETSC_OPTIONS or a petscrc file: options of PETSc's only
  checkpoint,    ///< what the run had that goes on from a checkpoint
  scene,         ///< the scene's file
  command_line,  ///< the words after it
};

/// One option as it was given.
struct Given {
  std::string value;  ///< empty: the bare name; items of a list are joined by commas
  Source source = Source::command_line;
  std::string place;     ///< for messages: "story.yaml, line 3", ".petscrc"; empty: none
  bool is_list = false;  ///< given as a YAML list
};

/// By name, without a dash, as in "sheet_length".
using GivenOptions = std::map<std::string, Given, std::less<>>;

/// All options of one run. Nothing of it is global: a process may hold several.
struct UserOptions {
  GivenOptions environment, scene, command_line;
  GivenOptions checkpoint = {};  ///< of a run that goes on: all that it had

  /// One value per name, the winner's.
  GivenOptions merged() const;
};

}  // namespace floe
