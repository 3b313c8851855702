#include "program.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string_view>
#include <vector>

#include "batch_command.h"
#include "floe/scene.h"
#include "floe/session/version.h"
#include "manual.h"
#include "options/option_values.h"
#include "options/spelling.h"
#include "parts_command.h"
#include "scenes.h"
#include "session/solver_options.h"
#include "subcommands.h"

namespace floe::program {
namespace {

constexpr auto usage =
    "usage: floe SCENE.yaml [-key value ...]   runs a scene; keys of the file are options too\n"
    "       mpiexec -n 4 floe SCENE.yaml ...   the same on four processors\n"
    "       floe TOOL [arguments]              draws results, makes lattices: see floe help\n"
    "       floe help [TOPIC]                  the tools; more about a tool, scenes or options\n"
    "       floe -help [SECTION or KEY]        options of scenes: default, unit, range\n"
    "       floe --version                     version of floe and of its libraries\n";

/// Returns the first of the launcher's variables that is set, null if none is.
template <std::size_t N>
const char* first_of(const std::array<const char*, N>& variables) {
  for (const char* variable : variables) {
    if (const char* value = std::getenv(variable)) return value;
  }
  return nullptr;
}

/// Prints on the first rank only, since all ranks would print the same. The other ranks return
/// success: a launcher ends all processes when one fails, possibly before the first rank has
/// printed.
int say(const std::string& text, Exit code, std::FILE* where = stdout) {
  if (!is_first_rank()) return done;
  std::fputs(text.c_str(), where);
  return code;
}

std::string introduction() {
  const std::filesystem::path scenes = scenes_folder();
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
  return text +
         "\nTopics: scenes (those that come with floe), options (all of them), a section or key "
         "of\n"
         "options (floe help sheet), version.\n";
}

/// Returns the help of a section, a key, or a family of PETSc's options; empty for other topics.
std::string options_about(const std::string& topic) {
  const std::string keys = options_topic(topic);
  return keys.empty() ? solver_options_help(topic) : keys;
}

int help(std::string_view topic) {
  if (topic.empty()) return say(help(), done);
  if (topic == "options") return say(options_help(), done);
  if (topic == "scenes") return say(list_of_scenes(), done);
  if (topic == "version") return say(version_text(), done);
  if (is_subcommand(topic)) {
    std::string name(topic), option = "--help";
    std::array<char*, 3> words{name.data(), option.data(), nullptr};
    return run_subcommand(words.data());
  }
  if (const std::string options = options_about(std::string(topic)); !options.empty())
    return say(options, done);
  std::vector<std::string_view> known{"options", "scenes", "version"};
  for (const Subcommand& tool : subcommands()) known.push_back(tool.name);
  const std::string near = nearest_word(topic, known);
  return say("floe help: there is no topic " + shown(topic) +
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
    if (first == "-make_parts") return make_parts(argc, argv);
    if (first == "-batch") return serve_batch(argc, argv);
    if (is_subcommand(first)) return run_subcommand(argv + 1);
  }
  const auto asks = [](std::string_view word) { return is_one_of(word, {"-h", "--help"}); };
  if (std::any_of(argv + 2, argv + argc, asks)) return say(introduction(), done);
  return {};
}

int print_options(const Help& help) {
  if (help.kind == Help::markdown) return say(options_markdown(), done);
  if (help.topic.empty()) return say(options_help(), done);
  const std::string options = options_about(help.topic);
  if (!options.empty()) return say(options, done);
  return say("floe: -help: there is no section or key " + shown(help.topic) +
                 " (floe -help lists them all)\n",
             bad_input, stderr);
}

}  // namespace floe::program
