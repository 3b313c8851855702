#include "files/run_log.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <utility>

#include "files/files.h"

namespace floe {
namespace {

constexpr std::size_t most_kept = 1U << 20;

/// The log of this process; one per process, like standard output.
struct Log {
  int file = -1;
  bool keeps = false;  ///< the log is not open yet and its text is kept
  std::string heading, kept;
};
Log& log() {
  static Log one;
  return one;
}

void put_on(std::FILE* stream, std::string_view text) {
  std::fwrite(text.data(), 1, text.size(), stream);
  std::fflush(stream);
}

}  // namespace

void print(std::string_view text) {
  put_into_log(text);
  put_on(stdout, text);
}

void print_error(std::string_view text) {
  put_into_log(text);
  std::fflush(stdout);  // keeps the order if both streams go to one file
  put_on(stderr, text);
}

void put_into_log(std::string_view text) noexcept {
  Log& me = log();
  if (me.keeps && me.kept.size() + text.size() <= most_kept) me.kept += text;
  if (me.file < 0 || write_all(me.file, text)) return;
  const char* why = std::strerror(errno);
  ::close(std::exchange(me.file, -1));
  std::fprintf(stderr, "floe: warning: the log ends here, it cannot be written: %s\n", why);
}

void keep_log(std::string heading) {
  log().heading = std::move(heading);
  log().keeps = true;
}

void open_log(const std::string& path, bool goes_on) {
  Log& me = log();
  if (!me.keeps) return;
  // A program that reads the log of an earlier run keeps that file.
  if (!goes_on && ::unlink(path.c_str()) != 0 && errno != ENOENT)
    throw_file_error("remove", path, errno);
  me.file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
  if (me.file < 0) throw_file_error("write", path, errno);
  me.keeps = false;
  const bool follows = ::lseek(me.file, 0, SEEK_END) > 0;
  const std::string text = (follows ? "\n---- the run goes on ----\n" : "") + me.heading + me.kept;
  me.heading = me.kept = {};
  if (write_all(me.file, text)) return;
  const int why = errno;
  ::close(std::exchange(me.file, -1));
  throw_file_error("write", path, why);
}

void close_log(std::string_view last_line) noexcept {
  Log& me = log();
  me.keeps = false;
  me.kept = {};
  put_into_log(last_line);
  if (me.file >= 0) ::close(std::exchange(me.file, -1));
}

void open_closed_streams() {
  for (int file = 0; file <= 2; ++file) {
    if (::fcntl(file, F_GETFD) >= 0 || errno != EBADF) continue;
    // open() takes the lowest free number, that is `file`.
    (void)::open("/dev/null", file == 0 ? O_RDONLY : O_WRONLY);
  }
}

}  // namespace floe
