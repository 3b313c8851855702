/// \file
/// The output folder of a run, from before anything in it is touched to the summary.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <mpi.h>

namespace floe {

/// What a run wants of its folder.
struct FolderWish {
  std::string dir;
  std::string scene;  ///< the scene file; may be the folder's own options.yaml
  std::vector<std::pair<std::string, std::string>>
      inputs;              ///< key and path of other files it reads
  bool overwrite = false;  ///< what an interrupted run, or somebody else, left may be lost
  bool goes_on = false;    ///< a restart: the folder's files are needed
};

/// The first line of the options.yaml that floe writes.
std::string options_heading();

/// Takes the lock of the folder, and refuses what would lose something. Until begin() nothing is
/// touched. Collective but for fail().
class RunFolder {
 public:
  /// \throws InputError if the folder is the root, a home, somebody else's, in use, or holds the
  /// checkpoint of a run that has not come to its end; or if an input would be overwritten
  RunFolder(const FolderWish& wish, MPI_Comm comm);
  ~RunFolder();
  RunFolder(const RunFolder&) = delete;
  RunFolder& operator=(const RunFolder&) = delete;

  /// What would have been thrown, as one line; empty: nothing. For a scene that is only checked.
  static std::string problem(const FolderWish& wish, MPI_Comm comm);

  /// How the run ended whose files are in a folder: the status in its summary.json, "unknown" where
  /// that cannot be read; empty if there is none. On one rank.
  static std::string status(const std::string& dir);
  /// The time at which its summary says that it ended [s]; 0 if it does not say.
  static double time(const std::string& dir);
  /// What identifies that run; empty if nobody knows. On one rank.
  static std::string run_in(const std::string& dir);

  /// What identifies the run whose files are in the folder; empty if nobody knows. On all ranks.
  const std::string& run() const { return run_; }
  /// From here on the run writes its files; those of an earlier one are removed unless it goes on.
  /// \param run  of a run that goes on; empty: a new one
  void begin(const std::string& run = {});
  bool has_begun() const { return begun_; }

  /// summary.json, whole. The run has come to an end.
  void finish(const std::string& summary);
  /// Writes a summary that says failed, when and why, as well as it can: also from one rank alone
  /// and where the disk is full. If the run has not begun yet, it begins with this, unless it is to
  /// go on with another. Never fails.
  void fail(const std::string& why) noexcept;
  /// Where the run has got to, for fail().
  void note(double time, long long step) { time_ = time, step_ = step; }

 private:
  void begin_here(const std::string& run);

  struct Impl;
  std::unique_ptr<Impl> impl_;  ///< rank 0
  MPI_Comm comm_;
  std::string dir_, run_, started_;
  bool begun_ = false, goes_on_;
  double time_ = 0;
  long long step_ = 0;
};

}  // namespace floe
