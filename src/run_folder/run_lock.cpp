#include "run_folder/run_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <thread>

#include "files/files.h"
#include "floe/base/petsc.h"

namespace floe {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view first_word = "floe run ";

std::string contents(int file) {
  std::array<char, 1000> text{};
  const ssize_t size = ::pread(file, text.data(), text.size(), 0);
  return {text.data(), static_cast<std::size_t>(std::max<ssize_t>(size, 0))};
}

std::string contents(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

/// Returns VALUE of the line "NAME VALUE" in a lock's text.
std::string value_of(const std::string& text, const std::string& name) {
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with(name + " ")) return line.substr(name.size() + 1);
  }
  return {};
}

std::string myself() {
  return "host " + host_name() + "\nprocess " + std::to_string(getpid()) + "\nsince " +
         date_and_time() + "\n";
}

std::string who(const std::string& text) {
  const std::string process = value_of(text, "process");
  if (process.empty()) return "a run";
  return "a run (process " + process + " on " + value_of(text, "host") + ", since " +
         value_of(text, "since") + ")";
}

[[noreturn]] void refuse(const std::string& dir, const std::string& holder) {
  throw InputError("output: dir: " + dir + " is in use by " + holder +
                   "; wait for its end or give another -output_dir");
}

[[noreturn]] void cannot(const std::string& what, const std::string& dir, int why) {
  const std::string text = "output: dir: cannot " + what + " '" + dir + "': " + std::strerror(why);
  if (why == ENOSPC || why == EDQUOT || why == EIO) throw FileError(text);
  throw InputError(text);
}

bool is_missing_feature(int error) {
  return error == ENOLCK || error == ENOSYS || error == EOPNOTSUPP || error == ENOTSUP;
}

/// Returns the first folder of a path that does not exist yet; empty if all exist.
std::string first_missing(const fs::path& dir) {
  std::error_code ignored;
  fs::path missing, there = fs::absolute(dir, ignored).lexically_normal();
  if (there.filename().empty()) there = there.parent_path();
  while (!fs::exists(fs::symlink_status(there, ignored)) && there.has_relative_path()) {
    missing = there;
    there = there.parent_path();
  }
  return missing.string();
}

}  // namespace

RunLock::RunLock(const std::string& dir)
    : dir_(dir), path_(dir + "/.lock"), held_path_(dir + "/.lock.held"), made_(first_missing(dir)) {
  // A run that gives up may remove the folder that it made at any moment, so making and opening are
  // repeated.
  constexpr int enough = 100;
  for (int attempt = 0; file_ < 0; ++attempt) {
    std::error_code error;
    fs::create_directories(dir, error);
    if (error) cannot("make the folder", dir, error.value());
    open();
    if (file_ < 0 && attempt == enough) cannot("lock", dir, ENOENT);
  }
  before_ = contents(file_);
  run_ = before_.starts_with(first_word) ? value_of(before_, "floe run") : "";
  write("floe run " + run_ + "\n" + myself());
}

/// Opens the lock's file; leaves file_ < 0 if the file was removed meanwhile.
void RunLock::open() {
  file_is_new_ = false;
  file_ = ::open(path_.c_str(), O_RDWR | O_CLOEXEC);
  if (file_ < 0 && errno == ENOENT) {
    file_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    file_is_new_ = file_ >= 0;
    if (file_ < 0 && (errno == ENOENT || errno == EEXIST)) return;
  }
  if (file_ < 0) cannot("lock", dir_, errno);
  const std::string text = contents(file_);
  if (!text.empty() && !text.starts_with(first_word)) {
    ::close(file_);
    throw InputError("output: dir: " + dir_ + " has a file .lock that is not floe's");
  }
  lock();
}

void RunLock::lock() {
  int why = 0;
  // A process that asks for the holder has the lock for a moment.
  constexpr int tries = 5;
  for (int k = 0; k < tries; ++k) {
    why = ::flock(file_, LOCK_EX | LOCK_NB) == 0 ? 0 : errno;
    if (why != EWOULDBLOCK) break;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  if (why != 0) {
    const std::string text = contents(file_);
    if (!is_missing_feature(why)) {
      ::close(std::exchange(file_, -1));
      if (why == EWOULDBLOCK) refuse(dir_, who(text));
      cannot("lock", dir_, why);
    }
    lock_without_flock(why);
  }
  struct stat mine {
  }, there{};
  const bool same = ::fstat(file_, &mine) == 0 && ::stat(path_.c_str(), &there) == 0 &&
                    mine.st_ino == there.st_ino && mine.st_dev == there.st_dev;
  if (!same) ::close(std::exchange(file_, -1));
}

/// Locks by creating a file: on any file system only one process can create it.
void RunLock::lock_without_flock(int why) {
  warning_ = "output: dir: " + dir_ + " is on a file system without flock (" + std::strerror(why) +
             "): the file .lock.held locks it, which a run that is killed leaves behind";
  for (int attempt = 0; attempt < 2; ++attempt) {
    const int held = ::open(held_path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (held >= 0) {
      const std::string text = myself();
      (void)!::write(held, text.data(), text.size());
      ::close(held);
      return;
    }
    if (errno != EEXIST) break;
    const std::string text = contents(held_path_);
    const std::string process = value_of(text, "process");
    const bool gone = value_of(text, "host") == host_name() && !process.empty() &&
                      ::kill(std::atoi(process.c_str()), 0) != 0 && errno == ESRCH;
    if (!gone) {
      ::close(std::exchange(file_, -1));
      refuse(dir_, who(text) + " (if it is gone, remove " + held_path_ + ")");
    }
    std::remove(held_path_.c_str());
  }
  const int error = errno;
  ::close(std::exchange(file_, -1));
  cannot("lock", dir_, error);
}

/// Writes the lock's text. If that fails the lock stays valid.
void RunLock::write(const std::string& text) const {
  if (::ftruncate(file_, 0) == 0) (void)!::pwrite(file_, text.data(), text.size(), 0);
}

void RunLock::keep(const std::string& run) {
  kept_ = true;
  run_ = run;
  write("floe run " + run_ + "\n" + myself());
}

RunLock::~RunLock() {
  write(kept_ ? "floe run " + run_ + "\n" : before_);
  if (!warning_.empty()) std::remove(held_path_.c_str());
  if (!kept_ && file_is_new_) {
    std::remove(path_.c_str());
    std::error_code ignored;
    // Removes the folders that were made for this run, from the innermost outwards, while they are
    // empty.
    fs::path folder = fs::absolute(dir_, ignored).lexically_normal();
    if (folder.filename().empty()) folder = folder.parent_path();
    const auto outside = fs::path(made_).parent_path();
    while (!made_.empty() && folder != outside && ::rmdir(folder.c_str()) == 0)
      folder = folder.parent_path();
  }
  ::close(file_);
}

std::string RunLock::run_in(const std::string& dir) {
  const int file = ::open((dir + "/.lock").c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  if (file < 0) return {};
  const std::string text = contents(file);
  ::close(file);
  return text.starts_with(first_word) ? value_of(text, "floe run") : "";
}

std::string RunLock::holder(const std::string& dir) {
  const int file = ::open((dir + "/.lock").c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) return {};
  std::string holder;
  if (::flock(file, LOCK_SH | LOCK_NB) != 0 && errno == EWOULDBLOCK) holder = who(contents(file));
  ::close(file);
  const std::string held = dir + "/.lock.held";
  if (holder.empty() && ::access(held.c_str(), F_OK) == 0) holder = who(contents(held));
  return holder;
}

}  // namespace floe
