/// \file
/// Tables of numbers in text files: rows of equal length, separated by commas, semicolons or
/// blanks;
/// "#" begins a comment, and the first line may be a heading.
#pragma once

#include <string>
#include <vector>

namespace floe {

/// Reads a table. Collective.
/// \param key      named in errors
/// \param columns  numbers of each row, as "length, tension"
/// \param least    number of rows that there must be
/// \throws InputError if the file is missing, or if a row has other numbers
std::vector<std::vector<double>> read_table(const std::string& file, const std::string& key,
                                            const std::vector<std::string>& columns,
                                            std::size_t least);

}  // namespace floe
