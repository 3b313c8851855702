#include "options/option_values.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace floe {
namespace {

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

/// Parses a number. from_chars refuses a plus sign, which users write.
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

namespace {

/// Parses "01:30:00" and "1-12:00:00" [s].
std::optional<double> of_a_clock(std::string_view text) {
  constexpr double day = 86400;
  double seconds = 0;
  if (const auto dash = text.find('-'); dash != std::string_view::npos) {
    const auto days = to_integer(text.substr(0, dash));
    if (!days || *days < 0) return {};
    seconds = day * static_cast<double>(*days);
    text.remove_prefix(dash + 1);
  }
  constexpr std::array<double, 3> units{3600, 60, 1};
  for (std::size_t k = 0; k < units.size(); ++k) {
    const auto colon = text.find(':');
    if ((colon == std::string_view::npos) != (k + 1 == units.size())) return {};
    const auto count = to_integer(text.substr(0, colon));
    if (!count || *count < 0 || (k > 0 && *count >= 60)) return {};
    seconds += units[k] * static_cast<double>(*count);
    text.remove_prefix(colon == std::string_view::npos ? text.size() : colon + 1);
  }
  return seconds;
}

}  // namespace

std::optional<double> to_duration(std::string_view text) {
  text = trimmed(text);
  if (const auto plain = to_number(text)) return plain;
  if (text.find(':') != std::string_view::npos) return of_a_clock(text);
  constexpr std::array<std::pair<char, double>, 4> units{
      {{'d', 86400}, {'h', 3600}, {'m', 60}, {'s', 1}}};
  double seconds = 0;
  auto unit = units.begin();
  while (!text.empty()) {
    const auto end = text.find_first_not_of("0123456789.");
    if (end == std::string_view::npos || end == 0) return {};
    const auto count = to_number(text.substr(0, end));
    unit = std::find_if(unit, units.end(), [&](const auto& u) { return u.first == text[end]; });
    if (!count || unit == units.end()) return {};
    seconds += *count * unit++->second;
    text = trimmed(text.substr(end + 1));
  }
  return seconds > 0 ? std::optional(seconds) : std::nullopt;
}

std::optional<bool> to_flag(std::string_view text) {
  const std::string word = lower(trimmed(text));
  if (word.empty() || word == "true" || word == "yes" || word == "on" || word == "1") return true;
  if (word == "false" || word == "no" || word == "off" || word == "0") return false;
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

Bounds bounds_of(std::string_view allowed) {
  constexpr double none = std::numeric_limits<double>::infinity();
  Bounds bounds{.least = -none, .most = none};
  for (std::string_view rest = allowed; !rest.empty();) {
    const auto comma = rest.find(", ");
    const std::string_view term = rest.substr(0, comma);
    const auto blank = term.find(' ');
    const std::string_view sign = term.substr(0, blank);
    const auto value =
        blank == std::string_view::npos ? std::nullopt : to_number(term.substr(blank + 1));
    if (!value || (sign != ">" && sign != ">=" && sign != "<" && sign != "<="))
      throw std::logic_error("table of options: range '" + std::string(allowed) + "'");
    (sign[0] == '>' ? bounds.least : bounds.most) = *value;
    (sign[0] == '>' ? bounds.above_least : bounds.below_most) = sign.size() == 1;
    rest = comma == std::string_view::npos ? std::string_view() : rest.substr(comma + 2);
  }
  return bounds;
}

bool in_range(double value, std::string_view allowed) {
  const Bounds bounds = bounds_of(allowed);
  return (bounds.above_least ? value > bounds.least : value >= bounds.least) &&
         (bounds.below_most ? value < bounds.most : value <= bounds.most);
}

std::string lower(std::string_view text) {
  std::string result(text);
  std::transform(result.begin(), result.end(), result.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return result;
}

bool is_name(std::string_view word) {
  constexpr std::size_t longest = 40;
  const auto fits = [](unsigned char c) { return c < 128 && std::isalnum(c); };
  return !word.empty() && word.size() <= longest && word != "names" &&
         std::all_of(word.begin(), word.end(), fits);
}

std::string allowed_text(const OptionSpec& spec) {
  const std::string range = spec.allowed.empty() ? "" : " " + std::string(spec.allowed);
  const std::string unit = spec.unit.empty() ? "" : " [" + std::string(spec.unit) + "]";
  switch (spec.kind) {
    case Kind::flag:
      return "true or false";
    case Kind::number:
      return "a number" + range + unit;
    case Kind::integer:
      return "an integer" + range + unit;
    case Kind::duration:
      return "a time (3h50m, 90s, 01:30:00 or seconds)" + range + unit;
    case Kind::numbers:
      return std::to_string(spec.count) + " numbers" + range + unit;
    case Kind::choice:
      return (choices_of(spec.allowed).size() > 1 ? "one of" + range : "the word" + range);
    case Kind::choices:
      return "a list of" + range + ", none twice";
    case Kind::names:
      return "a list of names (letters and digits, at most 40, none twice)";
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

std::string in_brackets(const std::string& place) {
  return place.empty() ? "" : " (" + place + ")";
}

void refuse_value(const OptionSpec& spec, const std::string& label, std::string_view value,
                  const std::string& place) {
  throw InputError(label + ": " + (value.empty() ? "no value given," : shown(value)) + " must be " +
                   allowed_text(spec) + place);
}

}  // namespace floe
