/// \file
/// One run at a time writes into a folder.
#pragma once

#include <string>

namespace floe {

/// The lock of an output folder: flock on its file .lock, which says who holds it and stays. The
/// system frees it whatever ends the process. On file systems without flock a file .lock.held takes
/// its place, which a process that is killed leaves behind. Lives on rank 0.
class RunLock {
 public:
  /// Makes the folder if it is not there, and takes its lock.
  /// \throws InputError if another run holds it, or if there can be no such folder; FileError where
  /// the disk is full
  explicit RunLock(const std::string& dir);
  /// Gives the lock back. Unless keep() was called, all is as it was before.
  ~RunLock();
  RunLock(const RunLock&) = delete;
  RunLock& operator=(const RunLock&) = delete;

  /// What identifies the run whose files are in the folder; empty if nobody knows.
  const std::string& run() const { return run_; }
  /// From here on the folder holds this run's files.
  void keep(const std::string& run);
  /// What the user should know of the lock; empty: nothing.
  const std::string& warning() const { return warning_; }

  /// What identifies the run whose files are in a folder; empty if nobody knows.
  static std::string run_in(const std::string& dir);
  /// Who holds the lock of a folder, as one line; empty if nobody does. Changes nothing.
  static std::string holder(const std::string& dir);

 private:
  void open();
  void lock();
  bool is_still_there() const;
  void lock_without_flock(int why);
  void write(const std::string& text) const;

  std::string dir_, path_, held_path_, run_, before_, made_, warning_;
  int file_ = -1;
  bool file_is_new_ = false, kept_ = false;
};

}  // namespace floe
