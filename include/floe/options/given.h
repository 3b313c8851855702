/// \file
/// The options that a user gave, as uninterpreted text: the options of floe and of PETSc alike, by
/// their names on the command line.
#pragma once

#include <functional>
#include <map>
#include <string>

namespace floe {

/// The source of an option. A later enumerator overrides an earlier one.
enum class Source {
  environment,   ///< PETSC_OPTIONS or a petscrc file; for options of PETSc only
  checkpoint,    ///< the options of the run that a checkpoint continues
  scene,         ///< the file of the scene
  command_line,  ///< the words after the scene's path
};

/// One option as given.
struct Given {
  std::string value;  ///< empty for a bare name; items of a list are joined by commas
  Source source = Source::command_line;
  std::string place;     ///< for messages: "story.yaml, line 3", ".petscrc"; empty: none
  bool is_list = false;  ///< whether the value is a YAML list
};

/// Options by name without a dash, for example "sheet_length".
using GivenOptions = std::map<std::string, Given, std::less<>>;

/// All options of one run. The options are not global: a process may hold several sets.
struct UserOptions {
  GivenOptions environment, scene, command_line;
  GivenOptions checkpoint = {};  ///< all options of the interrupted run, if this run continues one

  /// Returns one value per name, from the strongest source.
  GivenOptions merged() const;
};

}  // namespace floe
