#include "program.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string_view>
#include <vector>

#include "floe/base/spelling.h"
#include "floe/base/version.h"
#include "floe/scene.h"
#include "manual.h"
#include "places.h"
#include "subcommands.h"

namespace floe::program {
namespace {

namespace fs = std::filesystem;

constexpr auto usage =
    "usage: floe SCENE.yaml [-key value ...]   runs a scene; keys of the file are options too\n"
    "       mpiexec -n 4 floe SCENE.yaml ...   the same on four processors\n"
    "       floe TOOL [arguments]              draws results, makes lattices: see floe help\n"
    "       floe help [TOPIC]                  the tools; more about a tool or about options\n"
    "       floe -help                         all options of scenes: default, unit, range\n"
    "       floe --version                     version of floe and of its libraries\n";

/// Of the launcher's variables the first that is there.
template <std::size_t N>
const char* first_of(const std::array<const char*, N>& variables) {
  for (const char* variable : variables) {
    if (const char* value = std::getenv(variable)) return value;
  }
  return nullptr;
}

bool is_file(const fs::path& path) {
  std::error_code none;
  return fs::is_regular_file(path, none);
}

/// The shipped scenes' folder, or nothing.
fs::path scenes_folder() {
  std::error_code none;
  return fs::canonical(share_folder() / "input", none);
}

/// Names of a folder's scenes, without their extension.
std::vector<std::string> scenes_in(const fs::path& folder) {
  std::vector<std::string> names;
  std::error_code none;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, none)) {
    if (entry.path().extension() == ".yaml") names.push_back(entry.path().stem().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

/// A file of the name of a subcommand is a scene, unless it is the tool itself (in tools/).
bool is_scene(std::string_view word) {
  if (word.find_first_of("/.") != std::string_view::npos) return true;
  std::error_code none;
  return is_file(word) && !fs::equivalent(word, share_folder() / "tools" / word, none);
}

/// On the first rank only, or every rank would say the same.
int say(const std::string& text, Exit code, std::FILE* where = stdout) {
  if (is_first_rank()) std::fputs(text.c_str(), where);
  return code;
}

std::string introduction() {
  const fs::path scenes = scenes_folder();
  return "floe " + version() + ": floating sea ice as rigid bodies joined by beams\n\n" + usage +
         (scenes.empty() ? "" : "\nScenes to start from: " + scenes.string() + "\n");
}

std::string help() {
  std::string text = introduction() + "\nTools (floe help TOOL says more):\n";
  for (const Subcommand& tool : subcommands()) {
    std::string line = "  " + std::string(tool.name);
    line.resize(20, ' ');
    text += line + std::string(tool.line) + "\n";
  }
  return text + "\nTopics: options (all options of scenes), version.\n";
}

int help(std::string_view topic) {
  if (topic.empty()) return say(help(), done);
  if (topic == "options") return say(options_help(), done);
  if (topic == "version") return say(version_text(), done);
  if (is_subcommand(topic)) {
    std::string name(topic), option = "--help";
    std::array<char*, 3> words{name.data(), option.data(), nullptr};
    return run_subcommand(words.data());
  }
  std::vector<std::string_view> known{"options", "version"};
  for (const Subcommand& tool : subcommands()) known.push_back(tool.name);
  const std::string near = nearest_word(topic, known);
  return say("floe help: there is no topic '" + std::string(topic) + "'" +
                 (near.empty() ? "" : "; the nearest one is '" + near + "'") +
                 " (floe help lists them)\n",
             bad_input, stderr);
}

bool is_one_of(std::string_view word, std::initializer_list<std::string_view> words) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

}  // namespace

bool is_first_rank() {
  const char* rank = first_of(std::array{"OMPI_COMM_WORLD_RANK", "PMIX_RANK", "PMI_RANK"});
  return rank == nullptr || std::strcmp(rank, "0") == 0;
}

int ranks_of_launcher() {
  const char* size = first_of(std::array{"OMPI_COMM_WORLD_SIZE", "PMI_SIZE"});
  return size ? std::atoi(size) : 1;
}

std::optional<int> answer(int argc, char** argv) {
  if (argc < 2) return say(usage, bad_input, stderr);
  const std::string_view first = argv[1];
  if (!is_scene(first)) {
    if (is_one_of(first, {"-v", "--version", "-version", "version"}))
      return say(version_text(), done);
    if (is_one_of(first, {"-h", "--help"})) return say(introduction(), done);
    if (first == "help") return help(argc > 2 ? argv[2] : "");
    if (first == "-help_man") return say(manual_page(), done);
    if (is_subcommand(first)) return run_subcommand(argv + 1);
  }
  const auto asks = [](std::string_view word) { return is_one_of(word, {"-h", "--help"}); };
  if (std::any_of(argv + 2, argv + argc, asks)) return say(introduction(), done);
  return {};
}

std::string near_scene(const std::string& scene) {
  const fs::path given(scene), shipped = scenes_folder();
  const auto is_it = [](const fs::path& path) { return "; is it '" + path.string() + "'?"; };

  // The same name with the extension, here or among the scenes that came with floe
  const fs::path with_extension = fs::path(scene).replace_extension(".yaml");
  for (const fs::path& name : {with_extension, fs::path(scene + ".yaml")}) {
    if (is_file(name)) return is_it(name);
  }
  const fs::path inside = given.is_absolute() ? with_extension.filename() : with_extension;
  for (const fs::path& path : {shipped.parent_path() / inside, shipped / inside}) {
    if (!shipped.empty() && is_file(path)) return is_it(path);
  }

  // A tool, or a name that is nearly right
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
