/// \file
/// The scenes that come with floe, and names that are nearly those of scenes.
#pragma once

#include <filesystem>
#include <string>

namespace floe::program {

/// The shipped scenes' folder, or nothing.
std::filesystem::path scenes_folder();

/// The shipped scenes, each with the first sentence of its comment.
std::string list_of_scenes();

/// Whether a first word is a scene: a file, or a word with '/' or '.' in it. A tool is not,
/// although it is a file in tools/.
bool is_scene(std::string_view word);

}  // namespace floe::program
