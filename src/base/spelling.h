/// \file
/// How far two words are from each other, for messages that name the nearest known one.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace floe {

/// Levenshtein's distance, a swap of neighbours counting as one.
int spelling_distance(std::string_view a, std::string_view b);

/// The known word nearest to `word`, or nothing if all are farther than a third of its letters.
std::string nearest_word(std::string_view word, std::span<const std::string_view> known);

}  // namespace floe
