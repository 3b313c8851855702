#include "scene/table_file.h"

#include <algorithm>
#include <sstream>

#include "floe/base/petsc.h"
#include "options/option_values.h"
#include "options/text_file.h"

namespace floe {
namespace {

/// The words of a line, separated by commas, semicolons or blanks.
std::vector<std::string> words_of(std::string line) {
  std::replace_if(
      line.begin(), line.end(), [](char c) { return c == ',' || c == ';'; }, ' ');
  std::istringstream in(line);
  std::vector<std::string> words;
  for (std::string word; in >> word;) words.push_back(word);
  return words;
}

}  // namespace

std::vector<std::vector<double>> read_table(const std::string& file, const std::string& key,
                                            const std::vector<std::string>& columns,
                                            std::size_t least) {
  const std::string label = key + ": '" + file + "'";
  std::string wanted;
  for (const std::string& column : columns) wanted += (wanted.empty() ? "" : ", ") + column;
  constexpr std::size_t largest = 100'000'000;  // [B]
  std::istringstream in(read_text_file(label, file, largest, PETSC_COMM_WORLD));
  std::vector<std::vector<double>> rows;
  bool is_first = true;
  int number = 0;
  for (std::string line; std::getline(in, line);) {
    ++number;
    const std::vector<std::string> words = words_of(line.substr(0, line.find('#')));
    if (words.empty()) continue;
    std::vector<double> row;
    for (const std::string& word : words)
      if (const auto value = to_number(word)) row.push_back(*value);
    const bool is_row = row.size() == words.size() && row.size() == columns.size();
    const bool is_heading = is_first && row.empty();
    is_first = false;
    if (is_heading) continue;
    if (!is_row)
      throw InputError(label + ": line " + std::to_string(number) + ": must be " + wanted + ": " +
                       std::to_string(columns.size()) + " numbers");
    rows.push_back(std::move(row));
  }
  if (rows.size() < least)
    throw InputError(label + ": has " + std::to_string(rows.size()) + " rows of " + wanted +
                     ", must have " + std::to_string(least) + " at least");
  return rows;
}

}  // namespace floe
