/// \file
/// The text of a scene as options: libyaml parses it, and the keys of a section are joined to names
/// as on the command line. A text that is not a scene ends with one line that names the file and
/// the line.
#pragma once

#include <functional>
#include <string>
#include <string_view>

#include "floe/base/petsc.h"
#include "floe/options/given.h"

namespace floe {

/// Reads the options of a scene: one YAML document, a map of plain keys to values, lists of plain
/// values, or maps. No key may be given twice, also not as two keys that join to one name. An alias
/// (*x) may stand for a value or a list. The time is proportional to the length of any text.
/// \param path  for messages
/// \throws InputError with the path and the line
GivenOptions parse_scene(const std::string& path, const std::string& text,
                         Source source = Source::scene);

/// Reads a scene's file on rank 0 for all ranks. Collective.
/// \param near_to  returns words for the message if there is no such file, for example a similar
/// name
/// \throws InputError as parse_scene(), and if the file is not regular, cannot be read or is too
/// large
GivenOptions read_scene_text(const std::string& path, MPI_Comm comm = MPI_COMM_WORLD,
                             const std::function<std::string(const std::string&)>& near_to = {});

/// Returns why a value cannot stand in a line of text (options.yaml, for example): control
/// characters, or bytes that are not UTF-8. Empty if it can.
std::string text_problem(std::string_view value);

}  // namespace floe
