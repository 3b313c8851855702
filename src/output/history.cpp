#include "output/history.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <utility>

#include "files/files.h"
#include "floe/base/petsc.h"

namespace floe {

HistoryStart history_start(const std::string& path, std::int64_t keep) {
  HistoryStart start;
  if (keep <= 0) return start;
  std::ifstream old(path);
  std::string line;
  std::int64_t rows = -1;  // the first line is no row
  while (rows < keep && std::getline(old, line) &&
         !old.eof()) {  // eof: the line has no newline, it is torn
    if (line.find('\0') != std::string::npos)
      throw InputError("checkpoint: restart: '" + path + "' is damaged: line " +
                       std::to_string(rows + 2) + " has bytes that are no text");
    start.size += static_cast<std::int64_t>(line.size()) + 1;
    if (++rows == 0) start.header = line + "\n";
  }
  if (rows < keep)
    throw InputError("checkpoint: restart: '" + path + "' has " +
                     std::to_string(std::max<std::int64_t>(rows, 0)) +
                     " rows, the checkpoint knows of " + std::to_string(keep) +
                     ": a run goes on in the folder where it began");
  return start;
}

History::History(const std::string& path, std::int64_t keep) : path_(path) {
  const HistoryStart start = history_start(path, keep);
  size_ = start.size;
  header_ = start.header;
  // Appends wherever the end is: if another process empties the file, no hole is left in front.
  file_ = ::open(path.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
  if (file_ < 0 || ::ftruncate(file_, size_) != 0) throw_file_error("write", path, errno);
}

void History::close() {
  if (::close(std::exchange(file_, -1)) != 0) throw_file_error("write", path_, errno);
}

History::~History() {
  if (file_ >= 0) ::close(file_);
}

void History::write_header(const std::string& line) {
  write(line);
  header_ = line;
}

void History::sync() { sync_to_disk(path_); }

void History::write(const std::string& line) {
  const auto wanted = static_cast<::ssize_t>(line.size());
  ::ssize_t done = ::write(file_, line.data(), line.size());
  if (done >= 0 && done < wanted) {  // the disk is full: writing the rest gives the error
    const ::ssize_t rest =
        ::write(file_, line.data() + done, line.size() - static_cast<std::size_t>(done));
    done = rest < 0 ? -1 : done + rest;
  }
  if (done != wanted) {
    const std::string why = std::strerror(done < 0 ? errno : ENOSPC);
    if (::ftruncate(file_, size_) != 0) size_ = -1;
    throw FileError("cannot write " + path_ + ": " + why);
  }
  size_ += wanted;
}

}  // namespace floe
