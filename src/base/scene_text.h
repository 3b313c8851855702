/// \file
/// The text of a scene, as options: libyaml splits it, and sections join to names as on the command
/// line. What is no scene ends with one line that names file and line.
#pragma once

#include <functional>
#include <string>
#include <string_view>

#include "floe/base/given.h"
#include "floe/base/petsc.h"

namespace floe {

/// The options of a scene's text: one YAML document, a map of plain keys to values, lists of plain
/// values, or maps; no key given twice, nor two that join to one name. An alias (*x) may stand for
/// a value or a list. Takes time in proportion to the text, whatever is in it.
/// \param path  for messages
/// \throws InputError with the path and the line
GivenOptions parse_scene(const std::string& path, const std::string& text,
                         Source source = Source::scene);

/// The same of a file, which rank 0 reads for all ranks. Collective.
/// \throws InputError also if it is not a regular file, cannot be read or is too large
/// \param near_to  words to be added to the message if there is no such file, as a similar name
GivenOptions read_scene_text(const std::string& path, MPI_Comm comm = MPI_COMM_WORLD,
                             const std::function<std::string(const std::string&)>& near_to = {});

/// What keeps a value from standing in a line of text, in options.yaml among others: control
/// characters, bytes that are not UTF-8. Empty if nothing does.
std::string text_problem(std::string_view value);

}  // namespace floe
