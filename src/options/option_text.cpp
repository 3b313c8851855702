// Output of the table of options as help, Markdown and part of a man page, and of the options of a
// run as YAML.
#include <algorithm>
#include <cctype>
#include <iterator>

#include "floe/options/options.h"
#include "options/option_values.h"

namespace floe {
namespace {

/// Returns a YAML scalar: plain if that is safe, else in double quotes.
std::string quoted(std::string_view value) {
  const auto safe = [](unsigned char c) {
    return std::isalnum(c) ||
           std::string_view("_./+-").find(static_cast<char>(c)) != std::string_view::npos;
  };
  const bool plain = std::all_of(value.begin(), value.end(), safe) && value.front() != '-';
  if (plain || to_number(value)) return std::string(value);
  std::string text = "\"";
  for (const char c : value) {
    if (c == '"' || c == '\\') text += '\\';
    text += c;
  }
  return text + '"';
}

std::string yaml_value(Kind kind, const std::string& value) {
  if (kind != Kind::numbers && kind != Kind::choices && kind != Kind::names)
    return kind == Kind::text || kind == Kind::duration ? quoted(value) : value;
  const auto items = to_list(value).value_or(std::vector<std::string>{});
  std::string list;
  for (const std::string& item : items) list += (list.empty() ? "" : ", ") + item;
  return "[" + list + "]";
}

/// Returns the default for readers of the help.
std::string fallback_text(const OptionSpec& line) {
  return line.fallback == "(required)" ? "required" : std::string(line.fallback);
}

}  // namespace

std::string Options::yaml() const {
  std::string text;
  std::string_view open_section;
  std::string_view open_name;
  const auto put = [&](const OptionSpec& line, std::string_view name) {
    const auto found = read_.find(option_name(line.key, name));
    if (found == read_.end() || found->second.empty()) return;
    const std::string_view section = section_of(line.key);
    if (section != open_section && !section.empty()) text += std::string(section) + ":\n";
    if (name != open_name && !name.empty()) text += "  " + std::string(name) + ":\n";
    open_section = section;
    open_name = name;
    const auto depth = name.empty() ? (section.empty() ? 0U : 2U) : 4U;
    text += std::string(depth, ' ') + std::string(last_word(line.key)) + ": " +
            yaml_value(line.kind, found->second) + "\n";
  };
  for (auto line = table_.begin(); line != table_.end(); ++line) {
    if (!has_name(line->key)) {
      put(*line, {});
      continue;
    }
    // The lines of one named section stand together in the table; they are written name by name.
    const auto end = std::find_if(line, table_.end(), [&](const OptionSpec& other) {
      return !has_name(other.key) || section_of(other.key) != section_of(line->key);
    });
    for (const std::string& name : names(section_of(line->key)))
      std::for_each(line, end, [&](const OptionSpec& part) { put(part, name); });
    line = end - 1;
  }
  for (const auto& [name, option] : petsc_)
    text += name + (option.value.empty() ? ":" : ": " + quoted(option.value)) + "\n";
  return text;
}

std::string help_text(std::span<const OptionSpec> table) {
  std::string text;
  for (const OptionSpec& line : table) {
    std::string option = "-" + option_name(line.key);
    option.resize(std::max<std::size_t>(option.size() + 1, 34), ' ');
    text += "  " + option + std::string(line.doc) + "\n" + std::string(36, ' ') +
            allowed_text(line) + (line.fallback == "(required)" ? "; " : "; default ") +
            fallback_text(line) + "\n";
  }
  return text;
}

std::string help_topic(std::span<const OptionSpec> table, std::string_view topic) {
  std::string wanted(topic.substr(topic.starts_with('-') ? 1 : 0));
  while (wanted.ends_with(':')) wanted.pop_back();
  wanted = option_name(wanted);
  // The topic may have a name in the place of NAME: "obstacle_leg_shape".
  const auto fits = [&](const OptionSpec& line, std::string_view option) {
    const std::string name = option_name(line.key);
    if (name == option || name.starts_with(std::string(option) + "_")) return true;
    if (!has_name(line.key)) return false;
    const auto first = option.find('_');
    if (option.substr(0, first) != section_of(line.key)) return false;
    const auto second = option.find('_', first + 1);
    return second == std::string_view::npos || option.substr(second + 1) == last_word(line.key);
  };
  std::vector<OptionSpec> lines;
  std::copy_if(table.begin(), table.end(), std::back_inserter(lines),
               [&](const OptionSpec& line) { return fits(line, wanted); });
  return help_text(lines);
}

std::string help_markdown(std::span<const OptionSpec> table) {
  const auto cell = [](std::string text) {
    for (std::size_t at = 0; (at = text.find('|', at)) != std::string::npos; at += 2)
      text.insert(at, 1, '\\');
    return text;
  };
  std::string text;
  std::string_view section = "-";
  for (const OptionSpec& line : table) {
    if (section_of(line.key) != section) {
      section = section_of(line.key);
      text += "\n## " +
              (section.empty() ? std::string("Top level") : "`" + std::string(section) + ":`") +
              "\n\n| key | must be | default | |\n|---|---|---|---|\n";
    }
    text += "| `" + std::string(line.key) + "` | " + cell(allowed_text(line)) + " | " +
            cell(fallback_text(line)) + " | " + cell(std::string(line.doc)) + " |\n";
  }
  return text;
}

std::string help_man(std::span<const OptionSpec> table) {
  const auto escaped = [](std::string_view plain) {
    std::string text;
    for (const char c : plain) text += c == '\\' ? "\\e" : c == '-' ? "\\-" : std::string(1, c);
    const bool is_request = !text.empty() && (text.front() == '.' || text.front() == '\'');
    return (is_request ? "\\&" : "") + text;
  };
  std::string text;
  std::string_view section = "-";
  for (const OptionSpec& line : table) {
    if (section_of(line.key) != section) {
      section = section_of(line.key);
      text += ".SS " + (section.empty() ? std::string("Top level") : escaped(section)) + "\n";
    }
    text += ".TP\n.B " + escaped("-" + option_name(line.key)) + "\n" + escaped(line.doc) +
            "\n.br\n" + escaped(allowed_text(line)) +
            (line.fallback == "(required)" ? "; " : "; default ") + escaped(fallback_text(line)) +
            "\n";
  }
  return text;
}

}  // namespace floe
