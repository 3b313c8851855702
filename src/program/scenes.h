/// \file
/// The scenes that come with floe, and hints for misspelt names of scenes.
#pragma once

#include <filesystem>
#include <string>

namespace floe::program {

/// Returns the folder of the scenes that come with floe; empty if there is none.
std::filesystem::path scenes_folder();

/// Lists the scenes that come with floe, each with the first sentence of its comment.
std::string list_of_scenes();

/// Whether a first word is a scene: a file, or a word with '/' or '.' in it. A tool is no scene,
/// although it is a file in tools/.
bool is_scene(std::string_view word);

}  // namespace floe::program
