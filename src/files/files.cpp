#include "files/files.h"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <utility>

#include "floe/base/petsc.h"

namespace floe {
namespace {

/// A file descriptor, closed at the end of a scope.
class Descriptor {
 public:
  explicit Descriptor(int file) : file_(file) {}
  ~Descriptor() {
    if (file_ >= 0) ::close(file_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int get() const { return file_; }
  /// Closes and checks the result: a full network disk may be reported only here.
  bool close() { return ::close(std::exchange(file_, -1)) == 0; }

 private:
  int file_;
};

}  // namespace

bool write_all(int file, std::string_view text) {
  while (!text.empty()) {
    const ::ssize_t done = ::write(file, text.data(), text.size());
    if (done < 0 && errno == EINTR) continue;
    if (done == 0) errno = ENOSPC;
    if (done <= 0) return false;
    text.remove_prefix(static_cast<std::size_t>(done));
  }
  return true;
}

void throw_file_error(std::string_view what, const std::string& path, int error) {
  throw FileError("cannot " + std::string(what) + " " + path +
                  (error != 0 ? std::string(": ") + std::strerror(error) : ""));
}

std::string temporary_name(const std::string& path) {
  return path + "." + host_name() + "." + std::to_string(::getpid()) +
         std::string(temporary_ending);
}

void remove_left_over(const std::string& path) {
  namespace fs = std::filesystem;
  std::error_code ignored;
  const fs::path whole = fs::absolute(path, ignored);
  const std::string front = whole.filename().string() + "." + host_name() + ".";
  for (auto entry = fs::directory_iterator(whole.parent_path(), ignored);
       entry != fs::directory_iterator(); entry.increment(ignored)) {
    const std::string name = entry->path().filename().string();
    if (!name.starts_with(front) || !name.ends_with(temporary_ending)) continue;
    const char* end = name.data() + name.size() - temporary_ending.size();
    ::pid_t process = 0;
    if (std::from_chars(name.data() + front.size(), end, process).ptr != end || process <= 0)
      continue;
    const bool gone = process == ::getpid() || (::kill(process, 0) != 0 && errno == ESRCH);
    if (gone) fs::remove(entry->path(), ignored);
  }
}

std::string host_name() {
  std::array<char, 256> name{};
  if (::gethostname(name.data(), name.size() - 1) != 0) return "unknown";
  return name.data();
}

std::string date_and_time() {
  const std::time_t now = std::time(nullptr);
  std::tm local{};
  ::localtime_r(&now, &local);
  std::array<char, 40> text{};
  std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%S%z", &local);
  std::string date = text.data();
  if (date.size() > 2) date.insert(date.size() - 2, ":");
  return date;
}

void put_in_place(const std::string& temporary, const std::string& path, Place place) {
  // ext4 writes a file to disk when it is renamed over another one, but not in an exchange.
  if (place == Place::swapped &&
      ::renameat2(AT_FDCWD, temporary.c_str(), AT_FDCWD, path.c_str(), RENAME_EXCHANGE) == 0) {
    ::unlink(temporary.c_str());
    return;
  }
  if (std::rename(temporary.c_str(), path.c_str()) == 0) return;
  const int why = errno;
  ::unlink(temporary.c_str());
  throw_file_error("write", path, why);
}

void give_second_name(const std::string& path, const std::string& second) {
  const std::string temporary = temporary_name(second);
  ::unlink(temporary.c_str());
  if (::link(path.c_str(), temporary.c_str()) == 0) {
    put_in_place(temporary, second);
    ::unlink(temporary.c_str());  // rename() does nothing with two names of one file
    return;
  }
  const int why = errno;
  if (why == ENOENT) return;
  const bool has_no_links = why == EPERM || why == EOPNOTSUPP || why == ENOSYS || why == EMLINK;
  if (!has_no_links || std::rename(path.c_str(), second.c_str()) != 0)
    throw_file_error("write", second, why);
}

void write_whole(const std::string& path, std::string_view text, Place place) {
  const std::string temporary = temporary_name(path);
  Descriptor file(::open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666));
  if (file.get() < 0) throw_file_error("write", path, errno);
  if (!write_all(file.get(), text) || !file.close()) {
    const int why = errno;
    ::unlink(temporary.c_str());
    throw_file_error("write", path, why);
  }
  put_in_place(temporary, path, place);
}

void sync_to_disk(const std::string& path) {
  const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  // Some file systems cannot sync and report EINVAL.
  if (file.get() < 0 || (::fsync(file.get()) != 0 && errno != EINVAL))
    throw_file_error("write", path, errno);
}

}  // namespace floe
