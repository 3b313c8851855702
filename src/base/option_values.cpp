#include "option_values.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <stdexcept>

namespace floe {
namespace {

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

/// from_chars takes no plus sign, people write one.
template <class Number>
std::optional<Number> parse(std::string_view text) {
  text = trimmed(text);
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
  Number value{};
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc{} || stop != end || text.empty()) return {};
  return value;
}

std::string with_name(std::string_view key, std::string_view name) {
  std::string text(key);
  if (const auto at = text.find("NAME"); at != std::string::npos && !name.empty())
    text.replace(at, 4, name);
  return text;
}

}  // namespace

std::string option_label(std::string_view key, std::string_view name) {
  return with_name(key, name);
}

std::string option_name(std::string_view key, std::string_view name) {
  std::string text = with_name(key, name);
  for (std::size_t at; (at = text.find(": ")) != std::string::npos;) text.replace(at, 2, "_");
  return text;
}

std::string_view section_of(std::string_view key) {
  const auto colon = key.find(": ");
  return colon == std::string_view::npos ? std::string_view() : key.substr(0, colon);
}

std::string_view last_word(std::string_view key) { return key.substr(key.rfind(' ') + 1); }

bool has_name(std::string_view key) { return key.find(": NAME: ") != std::string_view::npos; }

std::optional<std::vector<std::string>> to_list(std::string_view text) {
  std::vector<std::string> items;
  text = trimmed(text);
  if (text.empty()) return items;
  for (;;) {
    const auto comma = text.find(',');
    std::string_view piece = trimmed(text.substr(0, comma));
    if (piece.empty()) return {};
    while (!piece.empty()) {
      const auto stop = std::find_if(piece.begin(), piece.end(), is_blank);
      items.emplace_back(piece.begin(), stop);
      piece = trimmed(piece.substr(static_cast<std::size_t>(stop - piece.begin())));
    }
    if (comma == std::string_view::npos) return items;
    text.remove_prefix(comma + 1);
  }
}

std::optional<double> to_number(std::string_view text) {
  const auto value = parse<double>(text);
  return value && std::isfinite(*value) ? value : std::nullopt;
}

std::optional<std::int64_t> to_integer(std::string_view text) { return parse<std::int64_t>(text); }

std::optional<bool> to_flag(std::string_view text) {
  std::string word(trimmed(text));
  std::transform(word.begin(), word.end(), word.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (word.empty() || word == "true" || word == "yes" || word == "1") return true;
  if (word == "false" || word == "no" || word == "0") return false;
  return {};
}

std::vector<std::string_view> choices_of(std::string_view allowed) {
  std::vector<std::string_view> words;
  for (;;) {
    const auto bar = allowed.find(" | ");
    words.push_back(allowed.substr(0, bar));
    if (bar == std::string_view::npos) return words;
    allowed.remove_prefix(bar + 3);
  }
}

bool in_range(double value, std::string_view allowed) {
  if (allowed.empty()) return true;
  if (allowed.starts_with("> ")) return value > to_number(allowed.substr(2)).value();
  if (allowed.starts_with(">= ")) return value >= to_number(allowed.substr(3)).value();
  if (allowed.starts_with("in (") && allowed.ends_with(")")) {
    const auto bounds = to_list(allowed.substr(4, allowed.size() - 5)).value();
    return value > to_number(bounds.at(0)).value() && value < to_number(bounds.at(1)).value();
  }
  throw std::logic_error("table of options: range '" + std::string(allowed) + "'");
}

bool is_name(std::string_view word) {
  const auto fits = [](char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9'); };
  return !word.empty() && word != "names" && std::all_of(word.begin(), word.end(), fits);
}

std::string allowed_text(const OptionSpec& spec) {
  const std::string range = spec.allowed.empty() ? "" : " " + std::string(spec.allowed);
  const std::string unit = spec.unit.empty() ? "" : " [" + std::string(spec.unit) + "]";
  switch (spec.kind) {
    case Kind::flag:
      return "true or false";
    case Kind::number:
      return "a finite number" + range + unit;
    case Kind::integer:
      return "an integer" + range + unit;
    case Kind::numbers:
      return std::to_string(spec.count) + " finite numbers" + range + unit;
    case Kind::choice:
      return (choices_of(spec.allowed).size() > 1 ? "one of" + range : "the word" + range);
    case Kind::choices:
      return "a list of" + range + ", none twice";
    case Kind::names:
      return "a list of names (lower-case letters and digits, none twice)";
    case Kind::text:
      return "a text";
  }
  return "";
}

std::string shown(std::string_view value) {
  constexpr std::size_t longest = 60;
  std::string text(value.substr(0, longest));
  for (char& c : text) {
    if (std::iscntrl(static_cast<unsigned char>(c))) c = ' ';
  }
  if (value.size() > longest) text += "...";
  const bool plain = !text.empty() && text.find(' ') == std::string::npos;
  return plain ? text : "'" + text + "'";
}

}  // namespace floe
