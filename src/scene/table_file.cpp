#include "scene/table_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
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

std::string short_text(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.6g", value);
  return text.data();
}

constexpr std::size_t largest_file = 100'000'000;  // [B]

/// Reads the heading of a table: which of the allowed columns follow the time.
std::vector<std::size_t> read_heading(const std::vector<std::string>& words,
                                      const std::vector<TableColumn>& allowed,
                                      const std::string& label) {
  const auto refuse = [&](const std::string& why) {
    std::string names;
    for (const TableColumn& column : allowed) names += (names.empty() ? "" : ", ") + column.name;
    throw InputError(label + ": heading: " + why + "; must be time, then at least one of " + names);
  };
  if (words.empty()) refuse("there is none");
  if (words.front() != "time") refuse("begins with '" + words.front() + "'");
  if (words.size() == 1) refuse("has time only");
  std::vector<std::size_t> columns;
  for (std::size_t k = 1; k < words.size(); ++k) {
    const auto found = std::find_if(allowed.begin(), allowed.end(), [&](const TableColumn& column) {
      return column.name == words[k];
    });
    if (found == allowed.end()) refuse("has '" + words[k] + "'");
    const auto which = static_cast<std::size_t>(found - allowed.begin());
    if (std::find(columns.begin(), columns.end(), which) != columns.end())
      refuse("has '" + words[k] + "' twice");
    columns.push_back(which);
  }
  return columns;
}

}  // namespace

std::vector<std::vector<double>> read_table(const std::string& file, const std::string& key,
                                            const std::vector<std::string>& columns,
                                            std::size_t least) {
  const std::string label = key + ": '" + file + "'";
  std::string wanted;
  for (const std::string& column : columns) wanted += (wanted.empty() ? "" : ", ") + column;
  std::istringstream in(read_text_file(label, file, largest_file, PETSC_COMM_WORLD));
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

HeadedTable read_headed_table(const std::string& file, const std::string& label,
                              const std::vector<TableColumn>& allowed) {
  std::istringstream in(read_text_file(label, file, largest_file, PETSC_COMM_WORLD));
  HeadedTable table;
  int number = 0;
  for (std::string line; std::getline(in, line);) {
    ++number;
    const std::vector<std::string> words = words_of(line.substr(0, line.find('#')));
    if (words.empty()) continue;
    if (table.columns.empty()) {
      table.columns = read_heading(words, allowed, label);
      continue;
    }
    const auto refuse = [&](const std::string& why) {
      throw InputError(label + ": line " + std::to_string(number) + ": " + why);
    };
    const std::size_t wanted = table.columns.size() + 1;
    if (words.size() != wanted)
      refuse("has " + std::to_string(words.size()) + " values, must have " +
             std::to_string(wanted) + ", as the heading");
    std::vector<double> row;
    for (const std::string& word : words) {
      const auto value = to_number(word);
      if (!value) refuse("'" + word + "' is no number");
      row.push_back(*value);
    }
    constexpr double latest = 1e12;  // [s]
    if (std::abs(row[0]) > latest) refuse("time " + words[0] + " must be >= -1e12, <= 1e12 [s]");
    if (!table.rows.empty() && !(row[0] > table.rows.back()[0]))
      refuse("time " + words[0] + " must be later than that of the row before [s]");
    for (std::size_t k = 1; k < wanted; ++k) {
      const auto& [name, unit, most] = allowed[table.columns[k - 1]];
      if (std::abs(row[k]) > most)
        refuse(name + " " + words[k] + " must be >= -" + short_text(most) +
               ", <= " + short_text(most) + " [" + unit + "]");
    }
    table.rows.push_back(std::move(row));
  }
  if (table.columns.empty()) table.columns = read_heading({}, allowed, label);
  if (table.rows.size() < 2)
    throw InputError(label + ": has " + std::to_string(table.rows.size()) +
                     (table.rows.size() == 1 ? " row" : " rows") + ", must have 2 at least");
  return table;
}

}  // namespace floe
