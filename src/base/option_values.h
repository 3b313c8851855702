/// \file
/// Text of an option to value, strictly: exact count, finite, nothing trailing.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "floe/base/options.h"

namespace floe {

/// "sheet: length" -> "sheet_length", with NAME replaced by `name` if there is one.
std::string option_name(std::string_view key, std::string_view name = {});
/// "boundary: NAME: fix" -> "boundary: a: fix".
std::string option_label(std::string_view key, std::string_view name = {});

/// "boundary" of "boundary: NAME: fix", "" of "gravity".
std::string_view section_of(std::string_view key);
/// "fix" of "boundary: NAME: fix".
std::string_view last_word(std::string_view key);
/// Whether a key is one of a named section.
bool has_name(std::string_view key);

/// Items separated by commas or blanks; nothing if an item between commas is empty.
std::optional<std::vector<std::string>> to_list(std::string_view text);
std::optional<double> to_number(std::string_view text);  ///< nothing unless finite
std::optional<std::int64_t> to_integer(std::string_view text);
/// A time by the clock [s]: numbers with units from the longest on (1d12h, 3h50m, 1.5h, 90s), as
/// hh:mm:ss or d-hh:mm:ss, or a number of seconds.
std::optional<double> to_duration(std::string_view text);
std::optional<bool> to_flag(std::string_view text);
/// "one | two" -> one, two.
std::vector<std::string_view> choices_of(std::string_view allowed);
/// The bounds that OptionSpec::allowed sets to numbers: infinite where it sets none.
struct Bounds {
  double least, most;
  bool above_least, below_most;  ///< the bound itself is not allowed
};
Bounds bounds_of(std::string_view allowed);
/// Whether a number is in the range `allowed` of an OptionSpec.
bool in_range(double value, std::string_view allowed);
/// Letters and digits, 1 to 40, and not the word "names" itself.
bool is_name(std::string_view word);
/// In lower case (ASCII).
std::string lower(std::string_view text);

/// What an option must be, in words: "a number > 0, <= 1e7 [m]".
std::string allowed_text(const OptionSpec& spec);
/// A value fit for one line of an error message: blanks for control characters, cut if long.
std::string shown(std::string_view value);
/// "PLACE" -> " (PLACE)"; nothing of nothing.
std::string in_brackets(const std::string& place);
/// Throws InputError: "LABEL: VALUE must be ...". \param place  in brackets, or nothing
[[noreturn]] void refuse_value(const OptionSpec& spec, const std::string& label,
                               std::string_view value, const std::string& place);

}  // namespace floe
