#include "options/scene_text.h"

#include <yaml.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <string_view>

#include "floe/options/options.h"
#include "options/option_names.h"
#include "options/option_values.h"
#include "options/text_file.h"

namespace floe {
namespace {

constexpr int deepest_key = 8;  // keys of floe have three words; PETSc's may have more
constexpr std::size_t longest_key = 120;
constexpr std::size_t largest_scene = 16U << 20;

constexpr auto unprintable = "has a character that cannot be printed";

bool has_control_character(std::string_view text) {
  return std::any_of(text.begin(), text.end(), [](unsigned char c) { return c < 32 || c == 127; });
}

/// Options that only the command line may give.
constexpr std::array<std::string_view, 6> command_line_only{
    "help", "options_monitor", "options_monitor_cancel", "skip_petscrc", "petsc_ci", "version"};

bool is_command_line_only(std::string_view word) {
  return std::find(command_line_only.begin(), command_line_only.end(), word) !=
         command_line_only.end();
}

/// One event of libyaml; deletes it on destruction.
class Event {
 public:
  explicit Event(yaml_parser_t& parser) : whole_(yaml_parser_parse(&parser, &event_) != 0) {}
  ~Event() {
    if (whole_) yaml_event_delete(&event_);
  }
  Event(const Event&) = delete;
  Event& operator=(const Event&) = delete;

  bool whole() const { return whole_; }
  yaml_event_type_t type() const { return event_.type; }
  std::size_t line() const { return event_.start_mark.line + 1; }
  std::string text() const {
    const auto& scalar = event_.data.scalar;
    return {reinterpret_cast<const char*>(scalar.value), scalar.length};
  }
  bool is_plain() const { return event_.data.scalar.style == YAML_PLAIN_SCALAR_STYLE; }
  std::string anchor() const {
    const yaml_char_t* name =
        type() == YAML_SCALAR_EVENT           ? event_.data.scalar.anchor
        : type() == YAML_SEQUENCE_START_EVENT ? event_.data.sequence_start.anchor
        : type() == YAML_MAPPING_START_EVENT  ? event_.data.mapping_start.anchor
        : type() == YAML_ALIAS_EVENT          ? event_.data.alias.anchor
                                              : nullptr;
    return name ? reinterpret_cast<const char*>(name) : "";
  }
  /// Returns a tag that is not one of YAML's own; tags such as !!str carry no information here.
  std::string foreign_tag() const {
    const yaml_char_t* tag = type() == YAML_SCALAR_EVENT           ? event_.data.scalar.tag
                             : type() == YAML_SEQUENCE_START_EVENT ? event_.data.sequence_start.tag
                             : type() == YAML_MAPPING_START_EVENT  ? event_.data.mapping_start.tag
                                                                   : nullptr;
    const std::string text = tag ? reinterpret_cast<const char*>(tag) : "";
    constexpr std::string_view core = "tag:yaml.org,2002:";
    const std::string_view kind = std::string_view(text).substr(std::min(text.size(), core.size()));
    constexpr std::array<std::string_view, 7> kinds{"str",  "int", "float", "bool",
                                                    "null", "seq", "map"};
    const bool known = text.empty() || (text.starts_with(core) &&
                                        std::find(kinds.begin(), kinds.end(), kind) != kinds.end());
    return known ? "" : text;
  }

 private:
  yaml_event_t event_{};
  bool whole_;
};

/// Reads a scene event by event; nesting deeper than a key may be is refused, so no deeper
/// structure is kept.
class SceneParser {
 public:
  SceneParser(std::string path, const std::string& text, Source source)
      : path_(std::move(path)), text_(text), source_(source) {
    yaml_parser_initialize(&parser_);
    const auto* bytes = reinterpret_cast<const unsigned char*>(text.data());
    yaml_parser_set_input_string(&parser_, bytes, text.size());
  }
  ~SceneParser() { yaml_parser_delete(&parser_); }
  SceneParser(const SceneParser&) = delete;
  SceneParser& operator=(const SceneParser&) = delete;

  GivenOptions parse() {
    expect(YAML_STREAM_START_EVENT);
    {
      const Event event(parser_);
      check_whole(event);
      // an empty scene; missing keys are reported later
      if (event.type() == YAML_STREAM_END_EVENT) return {};
    }
    {
      const Event event(parser_);
      check_whole(event);
      const bool nothing = event.type() == YAML_SCALAR_EVENT && event.text().empty();
      if (event.type() == YAML_MAPPING_START_EVENT) {
        read_map("", 1);
      } else if (!nothing) {
        refuse(event.line(), "a scene is a map of 'key: value' lines");
      }
    }
    expect(YAML_DOCUMENT_END_EVENT);
    const Event event(parser_);
    check_whole(event);
    if (event.type() != YAML_STREAM_END_EVENT)
      refuse(event.line(), "a scene is one YAML document, here a second one begins");
    return std::move(options_);
  }

 private:
  struct Value {
    std::string text;
    bool is_list = false;
  };

  void expect(yaml_event_type_t type) {
    const Event event(parser_);
    check_whole(event);
    if (event.type() != type) refuse(event.line(), "not a scene");
  }

  void check_whole(const Event& event) const {
    if (!event.whole()) refuse_syntax();
    if (const std::string tag = event.foreign_tag(); !tag.empty())
      refuse(event.line(), "tags (" + shown(tag) + ") are not for scenes");
  }

  [[noreturn]] void refuse_syntax() const {
    const std::string problem = parser_.problem ? parser_.problem : "not YAML";
    if (parser_.error == YAML_READER_ERROR) {
      const auto end = text_.begin() +
                       static_cast<std::ptrdiff_t>(std::min(parser_.problem_offset, text_.size()));
      const auto line = 1 + std::count(text_.begin(), end, '\n');
      refuse(static_cast<std::size_t>(line), "not a text in UTF-8: " + problem);
    }
    const std::size_t at = parser_.problem_mark.index;
    const bool tab = at < text_.size() && text_[at] == '\t';
    refuse(parser_.problem_mark.line + 1, tab ? "a tab; YAML wants blanks" : problem);
  }

  [[noreturn]] void refuse(std::size_t line, const std::string& why) const {
    throw InputError(path_ + ": line " + std::to_string(line) + ": " + why);
  }

  std::string checked_key(const Event& event, const std::string& prefix) {
    if (event.type() != YAML_SCALAR_EVENT)
      refuse(event.line(), "a key is a plain word, not a list, a map or an alias");
    const std::string word = event.text();
    const auto fits = [](unsigned char c) { return c < 128 && (std::isalnum(c) || c == '_'); };
    if (word.empty() || !std::all_of(word.begin(), word.end(), fits))
      refuse(event.line(),
             shown(word) + " is not a key: keys are words of letters, digits and '_'");
    std::string joined = prefix + word;
    if (!std::isalpha(static_cast<unsigned char>(joined[0])))
      refuse(event.line(), shown(word) + " is not a key: keys begin with a letter");
    joined = petsc_name(joined);
    if (joined.size() > (is_petsc_option(joined) ? longest_petsc_option : longest_key))
      refuse(event.line(), shown(joined) + " is longer than any key");
    if (reads_from_elsewhere(joined) || is_command_line_only(joined))
      refuse(event.line(), joined + " is for the command line or not supported, not for a scene");
    const auto [first, fresh] = lines_.try_emplace(joined, event.line());
    if (!fresh)
      refuse(event.line(),
             joined + " is given twice, first in line " + std::to_string(first->second));
    return joined;
  }

  void read_map(const std::string& prefix, int depth) {
    for (;;) {
      std::string name;
      std::size_t line = 0;
      {
        const Event key(parser_);
        check_whole(key);
        if (key.type() == YAML_MAPPING_END_EVENT) return;
        name = checked_key(key, prefix);
        line = key.line();
      }
      const Event event(parser_);
      check_whole(event);
      if (event.type() == YAML_MAPPING_START_EVENT) {
        if (depth >= deepest_key) refuse(event.line(), "nested deeper than any key");
        read_map(name + "_", depth + 1);
      } else {
        Value value = read_value(event, name);
        options_[name] = {.value = std::move(value.text),
                          .source = source_,
                          .place = path_.empty() ? "" : path_ + ", line " + std::to_string(line),
                          .is_list = value.is_list};
      }
    }
  }

  /// Returns the text of a value, with blanks for line breaks and tabs, because the text goes into
  /// lines and paths.
  std::string checked_text(const Event& event, const std::string& key) {
    std::string text = event.text();
    std::replace_if(
        text.begin(), text.end(), [](char c) { return c == '\n' || c == '\r' || c == '\t'; }, ' ');
    if (event.text().ends_with('\n')) text.erase(text.find_last_not_of(' ') + 1);
    if (has_control_character(text))
      refuse(event.line(), key + ": " + shown(text) + " " + unprintable);
    return text;
  }

  /// Returns a scalar, a list, or the value of an alias.
  Value read_value(const Event& event, const std::string& key) {
    if (event.type() == YAML_ALIAS_EVENT) return value_of_alias(event);
    Value value;
    if (event.type() == YAML_SCALAR_EVENT) {
      value.text = checked_text(event, key);
      const bool null = event.is_plain() && (value.text == "~" || lower(value.text) == "null");
      if (null) value.text.clear();
    } else {
      value = {.text = read_list(key), .is_list = true};
    }
    if (const std::string anchor = event.anchor(); !anchor.empty()) anchors_[anchor] = value;
    return value;
  }

  Value value_of_alias(const Event& event) {
    const auto found = anchors_.find(event.anchor());
    if (found == anchors_.end())
      refuse(event.line(), "the alias *" + shown(event.anchor()) + " stands for no value or list");
    expanded_ += found->second.text.size();
    if (expanded_ > largest_scene) refuse(event.line(), "aliases make this scene too large");
    return found->second;
  }

  std::string read_list(const std::string& key) {
    std::string list;
    for (bool first = true;; first = false) {
      const Event item(parser_);
      check_whole(item);
      if (item.type() == YAML_SEQUENCE_END_EVENT) return list;
      const bool scalar = item.type() == YAML_SCALAR_EVENT || item.type() == YAML_ALIAS_EVENT;
      const Value value = scalar ? read_value(item, key) : Value{};
      if (!scalar || value.is_list || value.text.empty())
        refuse(item.line(), key + ": a list holds plain values only");
      list += (first ? "" : ",") + value.text;
    }
  }

  std::string path_;
  const std::string& text_;
  Source source_;
  yaml_parser_t parser_{};
  GivenOptions options_;
  std::map<std::string, std::size_t> lines_;  ///< line in which each joined key was first given
  std::map<std::string, Value> anchors_;
  std::size_t expanded_ = 0;  ///< bytes that aliases have expanded to
};

void check_text(const std::string& path, const std::string& text) {
  if (text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff"))
    throw InputError(path + ": line 1: is a text in UTF-16; save it in UTF-8");
  if (const auto nul = text.find('\0'); nul != std::string::npos) {
    const auto end = text.begin() + static_cast<std::ptrdiff_t>(nul);
    throw InputError(path + ": line " + std::to_string(1 + std::count(text.begin(), end, '\n')) +
                     ": not a text (a byte 0)");
  }
}

}  // namespace

std::string text_problem(std::string_view value) {
  if (has_control_character(value)) return unprintable;
  // libyaml checks a comment as it checks a whole scene: the bytes must be printable UTF-8.
  const std::string comment = "# " + std::string(value);
  yaml_parser_t parser{};
  yaml_token_t token{};
  yaml_parser_initialize(&parser);
  yaml_parser_set_encoding(&parser, YAML_UTF8_ENCODING);
  yaml_parser_set_input_string(&parser, reinterpret_cast<const unsigned char*>(comment.data()),
                               comment.size());
  bool good = true;
  for (bool more = true; good && more;) {
    good = yaml_parser_scan(&parser, &token) != 0;
    more = good && token.type != YAML_STREAM_END_TOKEN;
    if (good) yaml_token_delete(&token);
  }
  yaml_parser_delete(&parser);
  return good ? "" : "is not a text in UTF-8";
}

GivenOptions parse_scene(const std::string& path, const std::string& text, Source source) {
  check_text(path, text);
  return SceneParser(path, text, source).parse();
}

GivenOptions read_scene_text(const std::string& path, MPI_Comm comm,
                             const std::function<std::string(const std::string&)>& near_to) {
  const std::string text =
      read_text_file("scene " + shown(path), path, largest_scene, comm, near_to);
  return parse_scene(path, text);
}

}  // namespace floe
