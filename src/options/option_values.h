/// \file
/// Strict conversion of an option's text to a value: exact count, finite numbers, no trailing text.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "floe/options/options.h"

namespace floe {

/// Returns "sheet_length" for "sheet: length", with NAME replaced by `name` if given.
std::string option_name(std::string_view key, std::string_view name = {});
/// Returns "boundary: a: fix" for "boundary: NAME: fix" and the name a.
std::string option_label(std::string_view key, std::string_view name = {});

/// Returns "boundary" for "boundary: NAME: fix", "" for "gravity".
std::string_view section_of(std::string_view key);
/// Returns "fix" for "boundary: NAME: fix".
std::string_view last_word(std::string_view key);
/// Whether a key belongs to a section with names.
bool has_name(std::string_view key);

/// Returns the items, separated by commas or blanks; nothing if an item between commas is empty.
std::optional<std::vector<std::string>> to_list(std::string_view text);
std::optional<double> to_number(std::string_view text);  ///< nothing unless finite
std::optional<std::int64_t> to_integer(std::string_view text);
/// Returns a wall time [s]: numbers with units in descending order (1d12h, 3h50m, 1.5h, 90s),
/// hh:mm:ss, d-hh:mm:ss, or a number of seconds.
std::optional<double> to_duration(std::string_view text);
std::optional<bool> to_flag(std::string_view text);
/// Returns the words of "one | two".
std::vector<std::string_view> choices_of(std::string_view allowed);
/// The bounds of OptionSpec::allowed for numbers; infinite if absent.
struct Bounds {
  double least, most;
  bool above_least = false, below_most = false;  ///< whether the bound itself is excluded
};
Bounds bounds_of(std::string_view allowed);
/// Whether a number lies in the range `allowed` of an OptionSpec.
bool in_range(double value, std::string_view allowed);
/// Whether a word is a name: 1 to 40 letters and digits, and not the word "names" itself.
bool is_name(std::string_view word);
/// Returns the text in lower case (ASCII).
std::string lower(std::string_view text);

/// Describes the permitted values of an option: "a number > 0, <= 1e7 [m]".
std::string allowed_text(const OptionSpec& spec);
/// Returns a value for one line of an error message: blanks for control characters, cut if long.
std::string shown(std::string_view value);
/// Returns " (PLACE)" for "PLACE", and "" for "".
std::string in_brackets(const std::string& place);
/// Throws InputError: "LABEL: VALUE must be ...". \param place  in brackets, or empty
[[noreturn]] void refuse_value(const OptionSpec& spec, const std::string& label,
                               std::string_view value, const std::string& place);

}  // namespace floe
