/// \file
/// The output folder of a run, from the checks before anything in it changes to the summary.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <mpi.h>

#include "run_folder/crash_summary.h"

namespace floe {

/// A run's claim to its folder.
struct FolderWish {
  std::string dir;
  std::string scene;  ///< the scene file; may be the folder's own options.yaml
  /// Key and path of other files that the run reads.
  std::vector<std::pair<std::string, std::string>> inputs;
  bool overwrite = false;  ///< results of an interrupted run or of others may be lost
  bool goes_on = false;    ///< a restart, which needs the folder's files
};

/// Returns the first line of the options.yaml that floe writes.
std::string options_heading();

/// Locks the folder and refuses runs that would lose data. Nothing in the folder changes before
/// begin(), apart from the lock. All calls but fail() are collective.
class RunFolder {
 public:
  /// \throws InputError if the folder is the root, a home, not that of a run, in use, or holds the
  ///   checkpoint of a run that is not done; or if an input would be overwritten
  RunFolder(const FolderWish& wish, MPI_Comm comm);
  ~RunFolder();
  RunFolder(const RunFolder&) = delete;
  RunFolder& operator=(const RunFolder&) = delete;

  /// Returns the message that the constructor would throw, as one line; empty if it would throw
  /// none. For a scene that is only checked. Collective.
  static std::string problem(const FolderWish& wish, MPI_Comm comm);

  /// Returns the status in the summary.json of a folder, "unknown" if it cannot be read, an empty
  /// string if there is none. Not collective.
  static std::string status(const std::string& dir);
  /// Returns the time at which that run ended, by its summary [s]; 0 if the summary has none.
  static double time(const std::string& dir);
  /// Returns the identifier of that run; empty if it is not known. Not collective.
  static std::string run_in(const std::string& dir);

  /// Identifier of the run whose files are in the folder; empty if it is not known. On all ranks.
  const std::string& run() const { return run_; }
  /// Begins to write files; those of an earlier run are removed unless it goes on.
  /// \param run  identifier of a run that goes on; empty: a new run
  void begin(const std::string& run = {});
  bool has_begun() const { return begun_; }

  /// Writes the whole summary.json at the end of the run.
  void finish(const std::string& summary);
  /// Writes a summary with the status failed, the time and the reason, as far as possible: also on
  /// a single rank and where the disk is full. If the run has not begun yet, it begins with this,
  /// unless it was to go on with another. Never fails.
  void fail(const std::string& why) noexcept;
  /// Does the same in the handler of a crash, by system calls only.
  /// \return whether the summary is there: not if the run has not begun, or if writing failed
  bool fail_in_crash(const char* why) const noexcept;
  /// Stores the time [s] and the step that fail() reports.
  void note(double time, long long step) { time_ = time, step_ = step; }

 private:
  void begin_here(const std::string& run);

  struct Impl;
  std::unique_ptr<Impl> impl_;  ///< rank 0
  MPI_Comm comm_;
  std::string dir_, run_, started_;
  std::optional<CrashSummary> crash_;
  bool begun_ = false, goes_on_;
  double time_ = 0;
  long long step_ = 0;
};

}  // namespace floe
