// The readers of the values of options. Each value is read once.
#include <algorithm>
#include <charconv>
#include <set>
#include <stdexcept>

#include "floe/options/options.h"
#include "options/option_values.h"

namespace floe {
namespace {

bool is_value(std::string_view fallback) { return !fallback.empty() && fallback.front() != '('; }

std::string shortest(double value) {
  std::array<char, 32> text{};
  const auto [end, error] = std::to_chars(text.data(), text.data() + text.size(), value);
  return std::string(text.data(), end);
}

}  // namespace

Options::Reading Options::read(std::string_view key, std::string_view name) {
  const OptionSpec& line = spec(key);
  Reading reading{.spec = line, .option = option_name(key, name), .label = option_label(key, name)};
  if (!read_.try_emplace(reading.option).second)
    throw std::logic_error("option read twice: " + reading.option);
  if (const auto found = given_.find(reading.option); found != given_.end()) {
    reading.value = found->second.value;
    reading.place = in_brackets(found->second.place);
    reading.is_list = found->second.is_list;
  } else if (is_value(line.fallback)) {
    reading.value = std::string(line.fallback);
  } else if (line.fallback == "(required)") {
    throw InputError(reading.label + ": is missing; it must be " + allowed_text(line));
  }
  return reading;
}

void Options::record(const Reading& reading, std::string value) {
  read_[reading.option] = std::move(value);
}

bool Options::flag(std::string_view key, std::string_view name) {
  const Reading reading = read(key, name);
  const std::string given = reading.value.value_or("false");
  const auto value = to_flag(given);
  if (!value) refuse_value(reading.spec, reading.label, given, reading.place);
  record(reading, *value ? "true" : "false");
  return *value;
}

constexpr std::string_view automatic =
    "(auto)";  // default of a number for which "auto" may be given

double Options::number(std::string_view key, std::string_view name,
                       std::optional<double> otherwise) {
  const Reading reading = read(key, name);
  if (otherwise && reading.spec.fallback == automatic && reading.value == "auto") {
    record(reading, "auto");
    return *otherwise;
  }
  if (!reading.value && otherwise) {
    record(reading, reading.spec.fallback == automatic ? "auto" : shortest(*otherwise));
    return *otherwise;
  }
  const std::string text = reading.value.value_or("");
  const auto value = to_number(text);
  if (!value || !in_range(*value, reading.spec.allowed))
    refuse_value(reading.spec, reading.label, text, reading.place);
  record(reading, text);
  return *value;
}

std::int64_t Options::integer(std::string_view key, std::string_view name) {
  const Reading reading = read(key, name);
  const std::string text = reading.value.value_or("");
  const auto value = to_integer(text);
  if (!value || !in_range(static_cast<double>(*value), reading.spec.allowed))
    refuse_value(reading.spec, reading.label, text, reading.place);
  record(reading, text);
  return *value;
}

double Options::duration(std::string_view key, std::string_view name) {
  const Reading reading = read(key, name);
  const std::string text = reading.value.value_or("");
  const auto value = to_duration(text);
  if (!value || !in_range(*value, reading.spec.allowed))
    refuse_value(reading.spec, reading.label, text, reading.place);
  record(reading, text);
  return *value;
}

std::string Options::text(std::string_view key, std::string_view name,
                          const std::optional<std::string>& otherwise) {
  const Reading reading = read(key, name);
  std::string value = reading.value ? *reading.value : otherwise.value_or("");
  if (value.empty() || reading.is_list)
    refuse_value(reading.spec, reading.label, value, reading.place);
  record(reading, value);
  return value;
}

std::vector<std::string> Options::words(std::string_view key, std::string_view name) {
  const Reading reading = read(key, name);
  const std::string text = reading.value.value_or("");
  auto list = to_list(text);
  const auto known = choices_of(reading.spec.allowed);
  const bool fits = list && std::set(list->begin(), list->end()).size() == list->size() &&
                    std::all_of(list->begin(), list->end(), [&](const std::string& word) {
                      return std::find(known.begin(), known.end(), word) != known.end();
                    });
  if (!fits) refuse_value(reading.spec, reading.label, text, reading.place);
  if (!list->empty()) record(reading, text);
  return *list;
}

void Options::read_numbers(std::string_view key, std::string_view name, std::span<double> values) {
  const Reading reading = read(key, name);
  const std::string text = reading.value.value_or("");
  const auto list = to_list(text);
  if (!list || list->size() != values.size())
    refuse_value(reading.spec, reading.label, text, reading.place);
  for (std::size_t k = 0; k < values.size(); ++k) {
    const auto value = to_number((*list)[k]);
    if (!value || !in_range(*value, reading.spec.allowed))
      refuse_value(reading.spec, reading.label, text, reading.place);
    values[k] = *value;
  }
  record(reading, text);
}

int Options::read_choice(std::string_view key, std::string_view name) {
  const Reading reading = read(key, name);
  const std::string text = reading.value.value_or("");
  const auto known = choices_of(reading.spec.allowed);
  auto chosen = std::find(known.begin(), known.end(), text);
  // A choice with the words true and false takes their other spellings too.
  const auto truth = to_flag(text);
  if (chosen == known.end() && truth && !text.empty())
    chosen = std::find(known.begin(), known.end(), *truth ? "true" : "false");
  if (chosen == known.end()) refuse_value(reading.spec, reading.label, text, reading.place);
  record(reading, std::string(*chosen));
  return static_cast<int>(chosen - known.begin());
}
}  // namespace floe
