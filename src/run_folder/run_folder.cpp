#include "run_folder/run_folder.h"

#include <fcntl.h>
#include <pwd.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <random>

#include "base/collectives.h"
#include "base/on_root.h"
#include "files/files.h"
#include "files/run_log.h"
#include "floe/files/log.h"
#include "run_folder/result_files.h"
#include "run_folder/run_lock.h"

namespace floe {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// Files that a run writes, apart from temporary files.
constexpr std::array<std::string_view, 11> results{
    "lattice.h5", "options.yaml", "history.csv",   "fields.h5",
    "fields.xmf", "breaks.h5",    "checkpoint.h5", "checkpoint_previous.h5",
    "floe.log",   "summary.json", "pressure.csv"};
/// Files removed when a run begins, since they would contradict it until it has written its own.
constexpr std::array<std::string_view, 6> contradicting{
    "pressure.csv",  "summary.json",           "fields.xmf",
    "checkpoint.h5", "checkpoint_previous.h5", "breaks.h5"};
/// Room on the disk for a summary that says that the disk is full.
constexpr std::size_t room = 4096;
constexpr auto reserve = "/.summary";

bool is_there(const fs::path& path) {
  std::error_code ignored;
  return fs::exists(path, ignored);
}

fs::path whole_path(const fs::path& path) {
  std::error_code error;
  const fs::path whole = fs::weakly_canonical(path, error);
  return error ? fs::absolute(path, error) : whole;
}

/// Whether a folder is one that no run may take: the root or the user's home.
bool is_never_a_folder(const fs::path& dir) {
  const fs::path there = whole_path(dir);
  if (there == there.root_path()) return true;
  const char* home = std::getenv("HOME");
  const passwd* user = getpwuid(geteuid());
  return (home != nullptr && *home != 0 && there == whole_path(home)) ||
         (user != nullptr && user->pw_dir != nullptr && there == whole_path(user->pw_dir));
}

bool is_folder_of_a_run(const fs::path& dir) {
  return is_there(dir / ".lock") || (is_there(dir / "options.yaml") &&
                                     is_there(dir / "lattice.h5") && is_there(dir / "history.csv"));
}

/// Returns the name of an entry of the folder that must not be overlooked; empty if there is none.
std::string first_entry(const fs::path& dir) {
  std::string first;
  std::error_code ignored;
  for (auto entry = fs::directory_iterator(dir, ignored); entry != fs::directory_iterator();
       entry.increment(ignored)) {
    const std::string name = entry->path().filename().string();
    if (name.starts_with(".") || name == "lost+found" || name == "STOP") continue;
    if (first.empty() || name < first) first = name;
  }
  return first;
}

/// Returns the name of the result in `dir` to which a path leads, also through links; empty if it
/// leads to none.
std::string result_named(const fs::path& path, const fs::path& dir) {
  const fs::path folder = whole_path(dir);
  for (const fs::path& way :
       {whole_path(path.parent_path().empty() ? "." : path.parent_path()) / path.filename(),
        whole_path(path)}) {
    std::string name = way.filename().string();
    if (way.parent_path() == folder &&
        std::find(results.begin(), results.end(), name) != results.end())
      return name;
    if (way.parent_path() == folder / "fields") return "fields";
  }
  return {};
}

bool was_written_by_floe(const fs::path& path) {
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);
  return line.starts_with("# floe");
}

void check_inputs(const FolderWish& wish) {
  for (const auto& [key, path] : wish.inputs) {
    const std::string name = result_named(path, wish.dir);
    if (!name.empty())
      throw InputError(key + ": " + path + " would be overwritten by the run's own " + name +
                       ", since it lies in 'output: dir: " + wish.dir +
                       "'; give another -output_dir");
  }
  const std::string name = result_named(wish.scene, wish.dir);
  if (name.empty() || (name == "options.yaml" && was_written_by_floe(wish.scene))) return;
  throw InputError("output: dir: " + wish.dir + ": the run would overwrite its scene " +
                   wish.scene + "; give another -output_dir");
}

constexpr std::string_view unknown = "unknown";

/// Returns the JSON of a file; a value of no type if the file holds none.
Json json_in(std::istream& file) {
  constexpr bool throwing = false;
  return Json::parse(file, nullptr, throwing);
}

std::string status_in(const fs::path& dir) {
  std::ifstream file(dir / "summary.json");
  if (!file) return {};
  const Json summary = json_in(file);
  if (!summary.is_object() || !summary.contains("status") || !summary["status"].is_string())
    return std::string(unknown);
  return summary["status"].get<std::string>();
}

/// Describes how the run ended whose checkpoint is in the folder; empty if it is done, or if there
/// is no checkpoint.
std::string interrupted(const fs::path& dir) {
  if (!is_there(dir / "checkpoint.h5") && !is_there(dir / "checkpoint_previous.h5")) return {};
  const std::string status = status_in(dir);
  if (status.empty()) return "it was interrupted";
  if (status == unknown) return "its summary cannot be read";
  return status == "done" ? "" : "its status is " + status;
}

void check_unfinished(const FolderWish& wish) {
  if (wish.goes_on || wish.overwrite) return;
  const std::string how = interrupted(wish.dir);
  if (how.empty()) return;
  const std::string checkpoint =
      is_there(wish.dir + "/checkpoint.h5") ? "/checkpoint.h5" : "/checkpoint_previous.h5";
  throw InputError("output: dir: " + wish.dir + " has the checkpoint of a run that is not done (" +
                   how + "); -checkpoint_restart " + wish.dir + checkpoint +
                   " goes on with it, -output_overwrite begins anew");
}

/// Makes all checks that are possible before the lock is taken.
void check_folder(const FolderWish& wish) {
  if (is_never_a_folder(wish.dir))
    throw InputError("output: dir: " + wish.dir +
                     " is no folder for results (the root, or a home); name one below it");
  check_inputs(wish);
  check_result_files(wish.dir, results);
  const std::string first = first_entry(wish.dir);
  if (first.empty() || wish.overwrite || is_folder_of_a_run(wish.dir)) return;
  throw InputError("output: dir: " + wish.dir + " is not empty and holds no run (it has '" + first +
                   "'); give another -output_dir, or -output_overwrite to use it all the same");
}

std::string new_run() {
  std::random_device chance;
  std::array<char, 40> text{};
  std::snprintf(text.data(), text.size(), "%08x%08x%08x", chance(), chance(),
                static_cast<unsigned>(std::chrono::system_clock::now().time_since_epoch().count() &
                                      0xffffffff));
  return text.data();
}

/// Writes into the room that was reserved, by system calls only, since the disk may be full.
bool write_into_reserve(const std::string& dir, const std::string& text) {
  const std::string path = dir + reserve;
  const int file = ::open(path.c_str(), O_WRONLY | O_CLOEXEC);
  if (file < 0) return false;
  const std::size_t size = std::min(text.size(), room);
  const bool good = ::pwrite(file, text.data(), size, 0) == static_cast<ssize_t>(size) &&
                    ::ftruncate(file, static_cast<off_t>(size)) == 0;
  ::close(file);
  return good && std::rename(path.c_str(), (dir + "/summary.json").c_str()) == 0;
}

/// Members of the summary of a run that failed, apart from why, where and when.
Json known_facts(const std::string& started, MPI_Comm comm) {
  return {{"ranks", size(comm)},
          {"host", host_name()},
          {"started", started},
          {"version", FLOE_VERSION}};
}

}  // namespace

std::string options_heading() {
  return std::string("# floe ") + FLOE_VERSION + ": every option of this run, as it was used\n";
}

struct RunFolder::Impl {
  FolderWish wish;
  RunLock lock;
};

RunFolder::RunFolder(const FolderWish& wish, MPI_Comm comm)
    : comm_(comm), dir_(wish.dir), started_(date_and_time()), goes_on_(wish.goes_on) {
  on_root(comm, [&] {
    check_folder(wish);
    impl_.reset(new Impl{wish, RunLock(wish.dir)});
    run_ = impl_->lock.run();
    try {
      check_unfinished(wish);
    } catch (...) {
      impl_.reset();
      throw;
    }
    if (!impl_->lock.warning().empty()) warn(impl_->lock.warning());
  });
  broadcast(run_, comm);
}

RunFolder::~RunFolder() = default;

std::string RunFolder::status(const std::string& dir) { return status_in(dir); }
double RunFolder::time(const std::string& dir) {
  std::ifstream file(dir + "/summary.json");
  const Json summary = json_in(file);
  if (!summary.is_object() || !summary.contains("time") || !summary["time"].is_number()) return 0;
  return summary["time"].get<double>();
}
std::string RunFolder::run_in(const std::string& dir) { return RunLock::run_in(dir); }

std::string RunFolder::problem(const FolderWish& wish, MPI_Comm comm) {
  std::string why;
  if (rank(comm) == 0) {
    why = outcome_of([&] {
            check_folder(wish);
            const std::string holder = RunLock::holder(wish.dir);
            if (!holder.empty())
              throw InputError("output: dir: " + wish.dir + " is in use by " + holder);
            check_unfinished(wish);
          }).why;
  }
  broadcast(why, comm);
  return why;
}

void RunFolder::begin(const std::string& run) {
  on_root(comm_, [&] { begin_here(run); });
  begun_ = true;
  broadcast(run_, comm_);
  crash_.emplace(
      dir_, reserve,
      known_facts(started_, comm_).dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
}

void RunFolder::begin_here(const std::string& run) {
  run_ = run.empty() ? new_run() : run;
  begun_ = true;
  impl_->lock.keep(run_);
  for (const std::string_view name : results) remove_left_over(dir_ + "/" + std::string(name));
  if (run.empty()) {
    std::error_code ignored;
    for (const std::string_view name : contradicting) fs::remove(fs::path(dir_) / name, ignored);
  }
  write_whole(dir_ + reserve, std::string(room, ' '));
  open_log(dir_ + "/floe.log", !run.empty());
}

void RunFolder::finish(const std::string& summary) {
  on_root(comm_, [&] {
    write_whole(dir_ + "/summary.json", summary);
    std::remove((dir_ + reserve).c_str());
  });
  begun_ = false;
}

bool RunFolder::fail_in_crash(const char* why) const noexcept {
  return begun_ && crash_ && crash_->write(why, time_, step_);
}

void RunFolder::fail(const std::string& why) noexcept {
  if (!begun_ && goes_on_) return;  // the files are those of the run to be continued
  try {
    if (!begun_ && impl_) begin_here({});
    Json json{{"status", "failed"},
              {"message", why},
              {"time", time_},
              {"steps", step_},
              {"ended", date_and_time()}};
    json.update(known_facts(started_, comm_));
    const std::string text = json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
    try {
      write_whole(dir_ + "/summary.json", text);
      std::remove((dir_ + reserve).c_str());
    } catch (const FileError&) {
      (void)write_into_reserve(dir_, text);
    }
  } catch (...) {  // NOLINT: nothing more can be done
  }
}

}  // namespace floe
