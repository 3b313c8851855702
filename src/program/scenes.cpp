#include "scenes.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <string_view>
#include <vector>

#include "options/spelling.h"
#include "places.h"
#include "program.h"
#include "subcommands.h"

namespace floe::program {
namespace {

namespace fs = std::filesystem;

bool is_file(const fs::path& path) {
  std::error_code none;
  return fs::is_regular_file(path, none);
}

/// Returns the names of a folder's scenes, without their extension.
std::vector<std::string> scenes_in(const fs::path& folder) {
  std::vector<std::string> names;
  std::error_code none;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, none)) {
    if (entry.path().extension() == ".yaml") names.push_back(entry.path().stem().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

/// Returns the first sentence of the comment at a scene's head, whose first line is a command.
std::string subject_of(const fs::path& scene) {
  std::ifstream file(scene);
  std::string line, text;
  std::getline(file, line);
  while (std::getline(file, line) && line.starts_with("# ")) text += line.substr(2) + " ";
  for (const std::string_view end : {". ", ": ", "; ", " ("}) text = text.substr(0, text.find(end));
  constexpr std::size_t longest = 76;
  if (text.size() > longest) text = text.substr(0, text.rfind(' ', longest)) + " ...";
  return text;
}

}  // namespace

fs::path scenes_folder() {
  std::error_code none;
  return fs::canonical(share_folder() / "input", none);
}

std::string list_of_scenes() {
  const fs::path folder = scenes_folder();
  if (folder.empty()) return "The scenes of " + program_file().string() + " are not there.\n";
  std::string text = "Scenes in " + folder.string() + ":\n";
  for (const std::string& name : scenes_in(folder)) {
    std::string line = "  " + name;
    line.resize(23, ' ');
    text += line + subject_of(folder / (name + ".yaml")) + "\n";
  }
  return text + "and in its folder verify those with a known answer.\n";
}

bool is_scene(std::string_view word) {
  if (word.find_first_of("/.") != std::string_view::npos) return true;
  std::error_code none;
  return is_file(word) && !fs::equivalent(word, share_folder() / "tools" / word, none);
}

std::string near_scene(const std::string& scene) {
  const fs::path given(scene), shipped = scenes_folder();
  const auto is_it = [](const fs::path& path) { return "; is it '" + path.string() + "'?"; };

  // The same name with the extension, here or among the scenes that come with floe
  const fs::path with_extension = fs::path(scene).replace_extension(".yaml");
  for (const fs::path& name : {with_extension, fs::path(scene + ".yaml")}) {
    if (is_file(name)) return is_it(name);
  }
  const fs::path inside = given.is_absolute() ? with_extension.filename() : with_extension;
  for (const fs::path& path : {shipped.parent_path() / inside, shipped / inside}) {
    if (!shipped.empty() && is_file(path)) return is_it(path);
  }

  // A tool, or a name with a spelling mistake
  if (!is_scene(scene)) {
    std::vector<std::string_view> known{"help", "version"};
    for (const Subcommand& tool : subcommands()) known.push_back(tool.name);
    const std::string near = nearest_word(scene, known);
    if (!near.empty()) return "; the nearest subcommand is '" + near + "' (floe help lists them)";
  }
  const fs::path parent = given.has_parent_path() ? given.parent_path() : fs::path(".");
  for (const fs::path& folder : {parent, shipped}) {
    const std::vector<std::string> names = scenes_in(folder);
    const std::vector<std::string_view> known(names.begin(), names.end());
    const std::string near = nearest_word(given.stem().string(), known);
    if (!near.empty()) return is_it((folder / (near + ".yaml")).lexically_normal());
  }
  return is_scene(scene) ? "" : "; floe help lists the subcommands";
}

}  // namespace floe::program
