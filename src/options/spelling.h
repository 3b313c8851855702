/// \file
/// Distances between words, for messages that name the nearest known word.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace floe {

/// Returns the Levenshtein distance, with a swap of neighbours as one edit.
int spelling_distance(std::string_view a, std::string_view b);

/// Returns the known word nearest to `word`; empty if all are farther than max(2, a third of its
/// letters).
std::string nearest_word(std::string_view word, std::span<const std::string_view> known);

}  // namespace floe
