#include "floe/base/scene_text.h"

#include <sys/stat.h>
#include <yaml.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstring>
#include <fstream>
#include <map>
#include <sstream>
#include <string_view>

#include "option_values.h"

namespace floe {
namespace {

constexpr std::size_t longest_key =
    60;                         // PETSc cuts longer names (PETSC_MAX_OPTION_NAME) in silence
constexpr int deepest_key = 8;  // PETSc aborts beyond 25; also ends an alias that holds itself
constexpr std::size_t largest_scene = 16U << 20;
constexpr std::size_t longest_path = 4000;  // below PETSC_MAX_PATH_LEN

/// Options by which PETSc reads further options before anybody can look at them.
constexpr std::array<std::string_view, 5> from_elsewhere{
    "options_file", "options_file_yaml", "options_string_yaml", "prefix_push", "prefix_pop"};
/// Options that PETSc takes from the command line only, and wants true or false for, or aborts.
constexpr std::array<std::string_view, 5> command_line_only{
    "help", "options_monitor", "options_monitor_cancel", "skip_petscrc", "petsc_ci"};
/// PETSc would begin a file of its own before we could refuse the word as unknown.
constexpr auto begins_a_file = "history";
constexpr auto not_history = ": unknown option; the nearest known one is 'output: history'";

template <std::size_t N>
bool contains(const std::array<std::string_view, N>& words, std::string_view word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

/// What PETSc takes for an option: a dash and a letter (-0.5, -inf and - are values).
bool is_option(std::string_view word) {
  if (word.size() < 2 || word[0] != '-') return false;
  if (word[1] == '-') return true;
  return std::isalpha(static_cast<unsigned char>(word[1])) && word != "-inf" && word != "-nan";
}

std::string lower(std::string_view text) {
  std::string result(text);
  std::transform(result.begin(), result.end(), result.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return result;
}

void check_option(std::string_view word, std::string_view value) {
  const std::string shown_word = shown(word);
  if (word.starts_with("--")) throw InputError(shown_word + ": options have one dash: -key value");
  if (word.find('=') != std::string_view::npos)
    throw InputError(shown_word + ": options are written -key value, without '='");
  if (word.size() > longest_key) throw InputError(shown_word + ": longer than any option");
  const std::string_view name = word.substr(1);
  if (contains(from_elsewhere, name))
    throw InputError(shown_word + ": not supported; put the options into the scene");
  if (name == begins_a_file) throw InputError(shown_word + not_history);
  if (contains(command_line_only, name) && !to_flag(value))
    throw InputError(shown_word + ": " + shown(value) + " must be true or false");
}

/// The scene as libyaml sees it, walked for what PETSc would join to options.
class SceneText {
 public:
  SceneText(std::string path, const std::string& text) : path_(std::move(path)) {
    yaml_parser_initialize(&parser_);
    const auto* bytes = reinterpret_cast<const unsigned char*>(text.data());
    yaml_parser_set_input_string(&parser_, bytes, text.size());
  }
  ~SceneText() { yaml_parser_delete(&parser_); }
  SceneText(const SceneText&) = delete;
  SceneText& operator=(const SceneText&) = delete;

  void check_all() {
    const Document scene(*this);
    const yaml_node_t* root = yaml_document_get_root_node(scene.get());
    if (!root) return;  // nothing in it: the options that are missing will be named
    if (root->type == YAML_SCALAR_NODE && root->data.scalar.length == 0) return;
    if (root->type != YAML_MAPPING_NODE) refuse(*root, "a scene is a map of 'key: value' lines");
    check_map(scene.get(), *root, "", 1);
    const Document next(*this);
    if (const auto* other = yaml_document_get_root_node(next.get()))
      refuse(*other, "a scene is one YAML document, here a second one begins");
  }

 private:
  /// One document of the parser, deleted with its life.
  class Document {
   public:
    explicit Document(SceneText& text) {
      if (!yaml_parser_load(&text.parser_, &document_)) text.refuse_syntax();
    }
    ~Document() { yaml_document_delete(&document_); }
    Document(const Document&) = delete;
    Document& operator=(const Document&) = delete;
    yaml_document_t* get() const { return &document_; }

   private:
    mutable yaml_document_t document_{};  // libyaml's getters take it without const
  };

  [[noreturn]] void refuse_syntax() const {
    const std::string problem = parser_.problem ? parser_.problem : "not YAML";
    if (parser_.error == YAML_READER_ERROR)
      throw InputError(path_ + ": not a YAML text: " + problem + " (byte " +
                       std::to_string(parser_.problem_offset) + ")");
    throw InputError(path_ + ": line " + std::to_string(parser_.problem_mark.line + 1) + ": " +
                     problem);
  }

  [[noreturn]] void refuse(const yaml_node_t& node, const std::string& why) const {
    throw InputError(path_ + ": line " + std::to_string(node.start_mark.line + 1) + ": " + why);
  }

  static std::string_view scalar(const yaml_node_t& node) {
    return {reinterpret_cast<const char*>(node.data.scalar.value), node.data.scalar.length};
  }

  std::string checked_key(const yaml_node_t& node, const std::string& prefix) {
    if (node.type != YAML_SCALAR_NODE) refuse(node, "a key is a plain word, not a list or a map");
    const std::string_view word = scalar(node);
    const auto fits = [](unsigned char c) { return std::isalnum(c) || c == '_'; };
    if (word.empty() || !std::all_of(word.begin(), word.end(), fits))
      refuse(node, shown(word) + " is not a key: keys are words of letters, digits and '_'");
    std::string joined = prefix + std::string(word);
    if (!std::isalpha(static_cast<unsigned char>(joined[0])))
      refuse(node, shown(word) + " is not a key: keys begin with a letter");
    if (joined.size() > longest_key) refuse(node, shown(joined) + " is longer than any key");
    if (contains(from_elsewhere, joined) || contains(command_line_only, joined))
      refuse(node, joined + " is for the command line or not supported, not for a scene");
    if (joined == begins_a_file) refuse(node, joined + not_history);
    // PETSc does not tell upper from lower case.
    const auto [first, fresh] = lines_.try_emplace(lower(joined), node.start_mark.line + 1);
    if (!fresh)
      refuse(node, joined + " is given twice, first in line " + std::to_string(first->second));
    return joined;
  }

  void check_map(yaml_document_t* document, const yaml_node_t& map, const std::string& prefix,
                 int depth) {
    if (depth > deepest_key) refuse(map, "nested deeper than any key");
    for (const auto* pair = map.data.mapping.pairs.start; pair < map.data.mapping.pairs.top;
         ++pair) {
      const yaml_node_t& key = *yaml_document_get_node(document, pair->key);
      const yaml_node_t& value = *yaml_document_get_node(document, pair->value);
      const std::string joined = checked_key(key, prefix);
      if (value.type == YAML_MAPPING_NODE) check_map(document, value, joined + "_", depth + 1);
      if (value.type == YAML_SEQUENCE_NODE) check_list(document, value, joined);
    }
  }

  void check_list(yaml_document_t* document, const yaml_node_t& list,
                  const std::string& key) const {
    for (const auto* item = list.data.sequence.items.start; item < list.data.sequence.items.top;
         ++item) {
      const yaml_node_t& node = *yaml_document_get_node(document, *item);
      if (node.type != YAML_SCALAR_NODE || scalar(node).empty())
        refuse(node, key + ": a list holds plain values only");
    }
  }

  std::string path_;
  yaml_parser_t parser_{};
  std::map<std::string, std::size_t> lines_;  ///< where each joined key was first given
};

using NearTo = std::function<std::string(const std::string&)>;

std::string read_file(const std::string& path, const NearTo& near_to) {
  if (path.size() > longest_path || path.find("${") != std::string::npos)
    throw InputError("scene " + shown(path) + ": PETSc cannot read a file of this name");
  struct stat status {};
  if (stat(path.c_str(), &status) != 0) {
    const std::string why = std::strerror(errno);
    throw InputError("scene " + shown(path) + ": " + why + (near_to ? near_to(path) : ""));
  }
  if (!S_ISREG(status.st_mode))
    throw InputError(
        "scene " + shown(path) + ": " +
        (S_ISDIR(status.st_mode) ? "is a directory, not a file" : "is not a regular file"));
  if (static_cast<std::size_t>(status.st_size) > largest_scene)
    throw InputError("scene " + shown(path) + ": too large for a scene");
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  if (!file) throw InputError("scene " + shown(path) + ": cannot be read");
  // PETSc takes the text as a C string.
  if (text.str().find('\0') != std::string::npos)
    throw InputError("scene " + shown(path) + ": not a text");
  return text.str();
}

}  // namespace

Help wants_help(int argc, const char* const* argv) {
  for (int k = 1; k < argc; ++k) {
    const std::string_view word = argv[k];
    if (word == "-help") return Help::text;
    if (word == "-help_markdown") return Help::markdown;
  }
  return Help::none;
}

std::string check_command_line(int argc, const char* const* argv) {
  constexpr auto usage = "usage: floe SCENE.yaml [-key value ...], or floe -help";
  if (argc < 2 || argv[1][0] == '-' || argv[1][0] == '\0')
    throw InputError(std::string("no scene is named; ") + usage);
  for (int k = 2; k < argc; ++k) {
    const std::string_view word = argv[k];
    if (!is_option(word)) throw InputError(shown(word) + ": belongs to no option; " + usage);
    const bool has_value = k + 1 < argc && !is_option(argv[k + 1]);
    check_option(word, has_value ? argv[k + 1] : "");
    if (has_value) ++k;
  }
  return argv[1];
}

void read_scene_text(const std::string& path, MPI_Comm comm, const NearTo& near_to) {
  std::string verdict;
  if (rank(comm) == 0) {
    try {
      const std::string text = read_file(path, near_to);
      SceneText(path, text).check_all();
    } catch (const InputError& error) {
      verdict = error.what();
    }
  }
  throw_verdict(std::move(verdict), comm);
}

}  // namespace floe
