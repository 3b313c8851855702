// Reading of tables in time.
#include <algorithm>
#include <array>
#include <cmath>

#include "reading.h"

namespace floe {
namespace {

/// The key beside that of a table: "water: level_table" -> "water: level_periodic".
std::string beside(const std::string& table, const char* last) {
  constexpr std::string_view ending = "table";
  return table.substr(0, table.size() - ending.size()) + last;
}

/// A key with its NAME.
std::string label_of(const std::string& key, const std::string& name) {
  std::string label = key;
  if (const auto at = label.find("NAME"); at != std::string::npos) label.replace(at, 4, name);
  return label;
}

/// Makes the last row the first, from which numbers in a file may differ by rounding.
void close_period(HeadedTable& table, const std::vector<TableColumn>& allowed,
                  const std::string& label) {
  constexpr double rounding = 1e-9;
  for (std::size_t k = 1; k < table.rows.front().size(); ++k) {
    const double first = table.rows.front()[k];
    double& last = table.rows.back()[k];
    double most = 0;
    for (const std::vector<double>& row : table.rows) most = std::max(most, std::abs(row[k]));
    if (std::abs(last - first) > rounding * most)
      throw InputError(label + ": is periodic, so " + allowed[table.columns[k - 1]].name +
                       " of its last row, " + text_of(last) + ", must be that of its first, " +
                       text_of(first));
    last = first;
  }
}

}  // namespace

ReadTable read_time_table(Options& options, Scene& scene, const TableKeys& keys,
                          const std::string& name) {
  ReadTable read;
  if (!options.given(keys.key, name)) return read;
  for (const std::string_view other : keys.replaces)
    options.refuse_one(other, name, "does not go with '" + label_of(keys.key, name) + "'");
  const std::string file = options.text(keys.key, name), key = label_of(keys.key, name),
                    label = key + ": '" + file + "'";
  scene.inputs.emplace_back(key, file);
  HeadedTable table = read_headed_table(file, label, keys.columns);
  const auto interpolation =
      options.choice<TimeTable::Interpolation>(beside(keys.key, "interpolation"), name);
  const bool periodic = options.flag(beside(keys.key, "periodic"), name);
  if (periodic) close_period(table, keys.columns, label);
  const auto is_zero = [](const std::vector<double>& row) {
    return std::all_of(row.begin() + 1, row.end(), [](double x) { return x == 0; });
  };
  if (std::all_of(table.rows.begin(), table.rows.end(), is_zero))
    throw InputError(label + ": all its values are 0; it would have no effect");
  read.has.resize(keys.columns.size());
  for (const std::size_t column : table.columns) read.has[column] = true;
  std::vector<std::vector<double>> rows;
  for (const std::vector<double>& row : table.rows) {
    rows.emplace_back(keys.columns.size() + 1).front() = row.front();
    for (std::size_t k = 0; k < table.columns.size(); ++k)
      rows.back()[table.columns[k] + 1] = row[k + 1];
  }
  read.table = TimeTable(rows, interpolation, periodic);
  scene.tables.push_back({key, file, std::move(rows)});
  return read;
}

MotionTable read_motion_table(Options& options, Scene& scene, const std::string& key,
                              const std::vector<std::string_view>& replaces,
                              TableRotations rotations, const std::string& name) {
  constexpr double farthest = 1e9, fastest = 1e6;
  TableKeys keys{key, replaces, {}};
  for (const char* column : {"ux", "uy", "uz"}) keys.columns.push_back({column, "m", farthest});
  for (const char* column : {"vx", "vy", "vz"}) keys.columns.push_back({column, "m/s", fastest});
  if (rotations != TableRotations::none)
    for (const char* column : {"rx", "ry", "rz"}) keys.columns.push_back({column, "rad", fastest});
  if (rotations == TableRotations::components)
    for (const char* column : {"wx", "wy", "wz"})
      keys.columns.push_back({column, "rad/s", fastest});
  const ReadTable read = read_time_table(options, scene, keys, name);
  MotionTable motion{.table = read.table};
  for (std::size_t k = 0; k < read.has.size(); ++k) {
    if (!read.has[k]) continue;
    const bool is_rate = k / 3 % 2 == 1;
    MotionTable::Column& column = motion.columns[k % 3 + 3 * (k / 6)];
    if (column.number >= 0)
      throw InputError(label_of(key, name) + ": has both " + keys.columns[k - 3].name + " and " +
                       keys.columns[k].name + "; one of them says it");
    column = {static_cast<std::int32_t>(k), is_rate};
  }
  return motion;
}

void require_start(const MotionTable& motion, const std::string& label) {
  for (std::size_t k = 0; k < motion.columns.size(); ++k) {
    const double begins = motion.value(k, 0);
    if (begins != 0)
      throw InputError(label + ": " + (k < 3 ? "u" : "") + std::string(component_names[k]) +
                       " is " + text_of(begins) + (k < 3 ? " m" : " rad") +
                       " at time 0, must be 0: the motion begins where the scene places it");
  }
}

}  // namespace floe
