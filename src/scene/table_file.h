/// \file
/// Tables of numbers in text files: rows of equal length, separated by commas, semicolons or
/// blanks; "#" begins a comment.
#pragma once

#include <string>
#include <vector>

namespace floe {

/// Reads a table whose first line may be a heading. Collective.
/// \param key      named in errors
/// \param columns  numbers of each row, as "length, tension"
/// \param least    number of rows that there must be
/// \throws InputError if the file is missing, or if a row has other numbers
std::vector<std::vector<double>> read_table(const std::string& file, const std::string& key,
                                            const std::vector<std::string>& columns,
                                            std::size_t least);

/// A column that a table may have.
struct TableColumn {
  std::string name, unit;
  double most;  ///< largest size
};
/// A table with a heading.
struct HeadedTable {
  std::vector<std::size_t> columns;  ///< which of the allowed columns the second and later ones are
  std::vector<std::vector<double>> rows;  ///< each a time [s] and these
};
/// Reads a table of values against time, whose heading names its columns: time, then some of the
/// allowed ones. Collective.
/// \param label  beginning of errors
/// \throws InputError if the file is missing, for another heading, a row of other numbers, less
/// than two rows, or times that do not rise
HeadedTable read_headed_table(const std::string& file, const std::string& label,
                              const std::vector<TableColumn>& allowed);

}  // namespace floe
