#include "floe/session/command_line.h"

#include <algorithm>
#include <array>
#include <string_view>

#include "floe/base/petsc.h"
#include "options/option_names.h"
#include "options/option_values.h"
#include "options/scene_text.h"
#include "session/environment.h"

namespace floe {
namespace {

constexpr std::size_t longest_option = 120;

/// Options for which PETSc aborts unless the value is true or false.
constexpr std::array<std::string_view, 4> flags_of_petsc{
    "options_monitor", "options_monitor_cancel", "skip_petscrc", "petsc_ci"};

void check_option(std::string_view word, std::string_view value) {
  const std::string shown_word = shown(word);
  if (const std::string problem = text_problem(value); !problem.empty())
    throw InputError(shown_word + ": " + shown(value) + " " + problem);
  if (word.starts_with("--")) throw InputError(shown_word + ": options have one dash: -key value");
  if (word.find('=') != std::string_view::npos)
    throw InputError(shown_word + ": options are written -key value, without '='");
  const std::string_view name = word.substr(1);
  if (name.size() > (is_petsc_option(name) ? longest_petsc_option : longest_option))
    throw InputError(shown_word + ": longer than any option");
  if (reads_from_elsewhere(name))
    throw InputError(shown_word + ": not supported; put the options into the scene");
  const bool flag =
      std::find(flags_of_petsc.begin(), flags_of_petsc.end(), name) != flags_of_petsc.end();
  if (flag && !to_flag(value))
    throw InputError(shown_word + ": " + shown(value) + " must be true or false");
}

constexpr auto usage = "usage: floe SCENE.yaml [-key value ...], or floe -help";

bool looks_like_a_scene(std::string_view word) {
  return word.ends_with(".yaml") || word.ends_with(".yml");
}

/// Refuses a command line that begins with an option; the message shows the command line with its
/// scene in front.
[[noreturn]] void refuse_option_first(int argc, const char* const* argv) {
  const std::string begin = std::string("the scene's file comes first, options after it; ") +
                            shown(argv[1]) + " is an option";
  std::string scene, rest;
  for (int k = 1; k < argc; ++k) {
    const std::string word = shown(argv[k]);
    if (scene.empty() && looks_like_a_scene(argv[k])) {
      scene = word;
    } else {
      rest += " " + word;
    }
  }
  throw InputError(begin + (scene.empty() ? std::string(", and no scene is named; ") + usage
                                          : ": floe " + scene + rest));
}

}  // namespace

Help wants_help(int argc, const char* const* argv) {
  for (int k = 1; k < argc; ++k) {
    const std::string_view word = argv[k];
    const bool has_topic = k + 1 < argc && !is_option_word(argv[k + 1]);
    if (word == "-help") return {Help::text, has_topic ? argv[k + 1] : ""};
    if (word == "-help_markdown") return {Help::markdown, ""};
  }
  return {};
}

CommandLine read_command_line(int argc, const char* const* argv) {
  const auto goes_on = [&] {
    return std::any_of(argv + 1, argv + argc,
                       [](std::string_view word) { return word == "-checkpoint_restart"; });
  };
  const bool has_scene = argc > 1 && argv[1][0] != '-' && argv[1][0] != '\0';
  if (!has_scene && argc >= 2 && is_option_word(argv[1]) && !goes_on())
    refuse_option_first(argc, argv);
  if (!has_scene && (argc < 2 || argv[1][0] == '\0' || !goes_on()))
    throw InputError(std::string("no scene is named; ") + usage);
  CommandLine line;
  if (has_scene) line.scene = argv[1];
  if (const std::string problem = text_problem(line.scene); !problem.empty())
    throw InputError("scene " + shown(line.scene) + ": its name " + problem);
  for (int k = has_scene ? 2 : 1; k < argc; ++k) {
    const std::string_view word = argv[k];
    if (!is_option_word(word)) throw InputError(shown(word) + ": belongs to no option; " + usage);
    const bool has_value = k + 1 < argc && !is_option_word(argv[k + 1]);
    const std::string value = has_value ? argv[k + 1] : "";
    check_option(word, value);
    if (word == "-skip_petscrc") {
      line.petscrc = !to_flag(value).value_or(true);  // check_option() has seen that it is one
    } else {
      line.options[petsc_name(word.substr(1))] = {value, Source::command_line, {}};
    }
    if (has_value) ++k;
  }
  return line;
}

UserOptions options_of(const CommandLine& line,
                       const std::function<std::string(const std::string&)>& near_to) {
  UserOptions options{read_environment(line.petscrc), {}, line.options};
  if (!line.scene.empty()) options.scene = read_scene_text(line.scene, MPI_COMM_WORLD, near_to);
  return options;
}

UserOptions options_of_text(const CommandLine& line, const std::string& name,
                            const std::string& text) {
  UserOptions options{read_environment(line.petscrc), {}, line.options};
  options.scene = parse_scene(name, text);
  for (auto& [option, given] : options.scene) given.place.clear();
  return options;
}

}  // namespace floe
