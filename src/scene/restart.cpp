#include "floe/scene/restart.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>

#include "base/collectives.h"
#include "base/on_root.h"
#include "floe/session/version.h"
#include "options/option_values.h"
#include "options/scene_text.h"
#include "restart_changes.h"
#include "run/checkpoint.h"
#include "run_folder/run_folder.h"

namespace floe {
namespace {

namespace fs = std::filesystem;

constexpr auto key = "checkpoint_restart";

/// The result of the search on rank 0.
struct Found {
  std::string file, done_in, remark;
  CheckpointHead head;
  double done_time = 0;  ///< end time of the run in done_in [s]
};

std::string seconds(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.9g", value);
  return text.data();
}

bool is_there(const std::string& path) {
  std::error_code ignored;
  return fs::exists(fs::symlink_status(path, ignored));
}

/// Returns an option of the command line or, if it has none, of the scene; null if neither gives
/// it.
const Given* given_anew(const UserOptions& user, std::string_view name) {
  for (const GivenOptions* options : {&user.command_line, &user.scene}) {
    if (const auto found = options->find(name); found != options->end()) return &found->second;
  }
  return nullptr;
}

/// Reads the head of the checkpoint that the user names.
Found named_checkpoint(const std::string& file) {
  try {
    return {file, {}, {}, read_head(file)};
  } catch (const InputError& error) {
    throw InputError(error.what() + older_generation(file));
  }
}

/// Returns the options of a run that is done and left no checkpoint.
std::string options_in(const std::string& dir) {
  std::ostringstream text;
  text << std::ifstream(dir + "/options.yaml").rdbuf();
  return text.str();
}

/// Finds the newest good checkpoint of a folder, if there is one.
Found newest_checkpoint(const std::string& dir) {
  const std::string newest = (fs::path(dir) / "checkpoint.h5").string(),
                    older = previous_checkpoint(newest);
  Found found;
  std::string problem;
  for (const std::string& file : {newest, older}) {
    if (!is_there(file) || !found.file.empty()) continue;
    try {
      found.head = read_head(file);
      found.file = file;
    } catch (const InputError& error) {
      if (problem.empty()) problem = error.what();
    }
  }
  if (!problem.empty() && found.file.empty())
    throw InputError(problem + "; no good checkpoint is in " + dir +
                     " (-output_overwrite without -checkpoint_restart begins anew)");
  if (!problem.empty())
    found.remark =
        problem + "; the one before it, of t = " + seconds(found.head.time) + " s, takes its place";
  if (RunFolder::status(dir) != "done") return found;
  found.done_in = dir;
  found.done_time = RunFolder::time(dir);
  if (found.file.empty()) found.head.options = options_in(dir);
  return found;
}

/// Broadcasts rank 0's result.
void share(Found& found, MPI_Comm comm) {
  CheckpointHead& head = found.head;
  for (std::string* text : {&found.file, &found.done_in, &found.remark, &head.version,
                            &head.built_for, &head.options, &head.scene, &head.run})
    broadcast(*text, comm);
  broadcast(head.ranks, comm);
  broadcast(head.time, comm);
  broadcast(found.done_time, comm);
}

/// Returns the output folder of a run whose scene has not been read yet.
std::string output_folder(const std::string& scene, const UserOptions& user) {
  const Given* dir = given_anew(user, "output_dir");
  return dir != nullptr ? dir->value : "out/" + fs::path(scene).stem().string();
}

/// Returns the options of the checkpoint's run.
GivenOptions options_of(const Found& found) {
  const std::string source =
      found.file.empty() ? found.done_in + "/options.yaml" : "'" + found.file + "'";
  GivenOptions options = parse_scene("", found.head.options, Source::checkpoint);
  std::erase_if(options, [](const auto& entry) { return !is_taken_along(entry.first); });
  for (auto& [name, given] : options) given.place = source;
  return options;
}

/// Adds a remark if version, level or number of ranks differ: results are the same to the last bit
/// only where these are.
void compare(const CheckpointHead& head, MPI_Comm comm, std::vector<std::string>& remarks) {
  const std::string built = built_for(comm);
  int ranks = 1;
  MPI_Comm_size(comm, &ranks);
  std::string differs;
  const auto add = [&](const std::string& what) {
    differs += (differs.empty() ? "" : ", ") + what;
  };
  if (head.version != version()) add("floe " + head.version + " (now " + version() + ")");
  if (head.built_for != built) add("a library for " + head.built_for + " (now " + built + ")");
  if (head.ranks != ranks)
    add(std::to_string(head.ranks) + (head.ranks == 1 ? " rank" : " ranks") + " (now " +
        std::to_string(ranks) + ")");
  if (!differs.empty())
    remarks.push_back("the checkpoint is of " + differs +
                      ": the run goes on with other roundings than it would have had");
}

}  // namespace

Restart find_restart(const std::string& scene, UserOptions& user, MPI_Comm comm) {
  Restart restart;
  restart.scene = scene;
  const Given* given = given_anew(user, key);
  if (given == nullptr) return restart;
  const std::string wanted = given->value;
  const bool is_auto = wanted == "auto";
  if (wanted.empty() || (is_auto && scene.empty()))
    throw InputError("checkpoint: restart: " +
                     std::string(is_auto ? "auto needs a scene: it says which folder is looked at"
                                         : "no value given, must be a file or auto"));
  Found found;
  on_root(comm, [&] {
    found = is_auto ? newest_checkpoint(output_folder(scene, user)) : named_checkpoint(wanted);
  });
  share(found, comm);
  restart.file = found.file;
  restart.run = found.head.run;
  restart.time = found.head.time;
  restart.done_in = found.done_in;
  if (!found.remark.empty()) restart.remarks.push_back(found.remark);
  if (found.file.empty() && found.head.options.empty()) return restart;  // the run begins at t = 0
  user.checkpoint = options_of(found);
  if (const auto end = user.checkpoint.find("time_end"); end != user.checkpoint.end())
    restart.done_end = to_number(end->second.value).value_or(0);
  if (found.file.empty()) return restart;
  // A run that -ts_max_steps ended has the status done, but has not reached its end.
  constexpr double rounding = 1e-9;
  if (found.done_time < (1 - rounding) * restart.done_end) {
    found.done_in.clear();
    restart.done_in.clear();
  }
  if (scene.empty()) restart.scene = found.head.scene;
  (user.command_line.contains(key) ? user.command_line : user.scene).at(key).value = found.file;
  // The run goes on in the folder that has its files, wherever that folder was moved.
  std::string dir = fs::path(found.file).parent_path().string();
  if (dir.empty()) dir = ".";
  bool is_its_folder = false;
  if (rank(comm) == 0)
    is_its_folder = !restart.run.empty() && RunFolder::run_in(dir) == restart.run;
  broadcast(is_its_folder, comm);
  if (is_its_folder) user.checkpoint["output_dir"].value = dir;
  if (found.done_in.empty())
    restart.remarks.push_back("goes on from '" + found.file + "', t = " + seconds(restart.time) +
                              " s");
  compare(found.head, comm, restart.remarks);
  return restart;
}

}  // namespace floe
