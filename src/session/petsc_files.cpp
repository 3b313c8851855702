#include "session/petsc_files.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <vector>

#include "floe/base/petsc.h"
#include "floe/session/session.h"
#include "options/option_values.h"

namespace floe {
namespace {

constexpr std::array on_file{"", "ascii", "binary", "hdf5", "vtk", "matlab", "glvis", "exodusii"};
constexpr std::array elsewhere{"draw", "socket", "string", "saws", "mathematica", "adios", "cgns"};

template <class Words>
bool is_one_of(std::string_view word, const Words& words) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

bool has_word(std::string_view name, std::string_view word) {
  return name.find(word) != std::string_view::npos;
}

/// A flag or a file: -info, -info FILE:classes.
bool is_log(std::string_view name) { return name == "info" || name == "log_trace"; }
/// A file without a type before it.
bool is_plain(std::string_view name) {
  constexpr std::array names{"citations", "malloc_view", "log_summary", "log_all"};
  return is_one_of(name, names);
}

/// A viewer's value is TYPE:FILE:FORMAT:MODE.
bool is_viewer(std::string_view name) {
  return !is_plain(name) &&
         (has_word(name, "view") || has_word(name, "monitor") || has_word(name, "reason"));
}

/// The file that an option names; empty: none. PETSc takes a log's `0` for a name too.
std::string file_of(std::string_view name, std::string_view value) {
  const auto colon = value.find(':');
  std::string_view file;
  if (is_log(name)) {
    file = value.substr(0, colon);
  } else if (is_plain(name)) {
    file = name == "log_all" && value.empty() ? "Log" : value;  // as PETSc calls it
  } else if (is_viewer(name) && colon != std::string_view::npos &&
             is_one_of(value.substr(0, colon), on_file)) {
    file = value.substr(colon + 1);
    file = file.substr(0, file.find(':'));
  }
  const bool is_none = file.empty() || file == "stdout" || file == "stderr";
  return is_none || (is_plain(name) && to_flag(file)) ? "" : std::string(file);
}

/// Why a file cannot be written, or nothing.
std::string file_problem(std::string_view name, const std::string& file) {
  std::error_code error;
  const std::filesystem::path path(file);
  const auto folder = path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
  const std::string begin = std::string(name) + ": '" + file + "' cannot be written: ";
  if (!std::filesystem::is_directory(folder, error))
    return begin + "there is no folder '" + folder.string() + "'";
  if (std::filesystem::is_directory(path, error)) return begin + "it is a folder";
  const bool there = std::filesystem::exists(path, error);
  if (access(there ? path.c_str() : folder.c_str(), W_OK) != 0) return begin + "no permission";
  return {};
}

/// Whether PETSc would open a window: TYPE is draw, or a monitor's name says so.
bool draws(std::string_view name, std::string_view value) {
  if (is_viewer(name) && value.substr(0, value.find(':')) == "draw") return true;
  const bool named = has_word(name, "_draw") || has_word(name, "_lg_") || name.ends_with("_lg");
  return named && to_flag(value).value_or(true);
}

bool has_display(const GivenOptions& all) {
  const char* variable = std::getenv("DISPLAY");
  if (variable != nullptr && *variable != '\0') return true;
  const auto type = all.find("draw_type");
  return all.contains("display") || all.contains("nox") ||
         (type != all.end() && type->second.value != "x");
}

/// Those that go with a refused run; of the process, as PETSc's table of options.
std::vector<std::string>& new_files() {
  static std::vector<std::string> files;
  return files;
}

}  // namespace

std::string petsc_file_problem(std::string_view name, std::string_view value,
                               const GivenOptions& all) {
  if (draws(name, value) && !has_display(all))
    return std::string(name) + (value.empty() ? "" : " " + shown(value)) +
           ": there is no display to draw on (DISPLAY is not set); -draw_type image draws files";
  const auto colon = value.find(':');
  // PETSc looks at these at the end of a run.
  const bool is_late =
      name.ends_with("ts_view") || name.ends_with("ts_view_solution") || name.ends_with("log_view");
  const std::string_view type = value.substr(0, colon);
  if (is_viewer(name) && !value.empty() && (colon != std::string_view::npos || is_late) &&
      !is_one_of(type, elsewhere) && !is_one_of(type, on_file))
    return std::string(name) + ": " + shown(value) +
           " must be one of PETSc's viewers: ascii:FILE, binary:FILE, hdf5:FILE, ...";
  const std::string file = file_of(name, value);
  return file.empty() ? "" : file_problem(name, file);
}

void note_petsc_files(const GivenOptions& options) {
  std::vector<std::string>& files = new_files();
  files.clear();
  const std::string me = std::to_string(rank(MPI_COMM_WORLD));
  for (const auto& [name, given] : options) {
    const std::string file = file_of(name, given.value);
    if (file.empty()) continue;
    // Logs have a file for each rank, a binary viewer one more for what it says of the objects.
    for (const std::string& made : {file, file + "." + me, file + "_" + me, file + ".info"}) {
      std::error_code error;
      if (!std::filesystem::exists(made, error)) files.push_back(made);
    }
  }
}

void drop_petsc_files() noexcept {
  for (const std::string& file : new_files()) (void)::unlink(file.c_str());
}

}  // namespace floe
