/// \file
/// The lock by which only one run at a time writes into a folder.
#pragma once

#include <string>

namespace floe {

/// The lock of an output folder: flock on its file .lock, which names the holder and stays in the
/// folder. The system releases flock however the process ends. On file systems without flock a file
/// .lock.held takes its place, which a killed process leaves behind. Lives on rank 0.
class RunLock {
 public:
  /// Makes the folder if it does not exist, and locks it.
  /// \throws InputError if another run holds the lock, or if the folder cannot be made
  /// \throws FileError if the disk is full
  explicit RunLock(const std::string& dir);
  /// Releases the lock. Unless keep() was called, the folder is then as it was before.
  ~RunLock();
  RunLock(const RunLock&) = delete;
  RunLock& operator=(const RunLock&) = delete;

  /// Identifier of the run whose files are in the folder; empty if it is not known.
  const std::string& run() const { return run_; }
  /// Marks the folder as holding the files of this run.
  void keep(const std::string& run);
  /// Warning about the lock for the user; empty if there is none.
  const std::string& warning() const { return warning_; }

  /// Returns the identifier of the run whose files are in a folder; empty if it is not known.
  static std::string run_in(const std::string& dir);
  /// Returns the holder of a folder's lock as one line; empty if nobody holds it. Changes nothing.
  static std::string holder(const std::string& dir);

 private:
  void open();
  void lock();
  void lock_without_flock(int why);
  void write(const std::string& text) const;

  std::string dir_, path_, held_path_, run_, before_, made_, warning_;
  int file_ = -1;
  bool file_is_new_ = false, kept_ = false;
};

}  // namespace floe
