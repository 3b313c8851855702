#include "files/seal.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <string_view>
#include <vector>

#include "files/files.h"

namespace floe {
namespace {

constexpr std::string_view first_line = "floe checkpoint\n";

struct Facts {
  unsigned long long size = 0;  ///< of the file, with the seal
  unsigned long sum = 0;        ///< CRC-32 of the bytes after the seal
};

/// Returns the seal. Each pair of facts has one text only, so a change of any bit of the seal is
/// detected.
std::string text_of(const Facts& facts) {
  std::array<char, 80> line{};
  std::snprintf(line.data(), line.size(), "size %llu\ncrc32 %08lx\n", facts.size, facts.sum);
  std::string text = std::string(first_line) + line.data();
  text.resize(seal_size, '\n');
  return text;
}

/// A file descriptor, closed at the end of a scope.
class Opened {
 public:
  Opened(const std::string& path, int how)
      : file_(::open(path.c_str(), how | O_NONBLOCK | O_CLOEXEC)) {}
  ~Opened() {
    if (file_ >= 0) ::close(file_);
  }
  Opened(const Opened&) = delete;
  Opened& operator=(const Opened&) = delete;
  int get() const { return file_; }

 private:
  int file_;
};

/// Computes size and checksum of a file; false if it cannot be read.
bool look_at(int file, Facts& facts) {
  std::vector<unsigned char> block(1 << 18);
  facts = {seal_size, ::crc32(0, nullptr, 0)};
  for (;;) {
    const ::ssize_t size =
        ::pread(file, block.data(), block.size(), static_cast<::off_t>(facts.size));
    if (size < 0) return false;
    if (size == 0) return true;
    facts.sum = ::crc32(facts.sum, block.data(), static_cast<uInt>(size));
    facts.size += static_cast<unsigned long long>(size);
  }
}

}  // namespace

void seal(const std::string& path) {
  const Opened file(path, O_RDWR);
  Facts facts;
  const bool good = file.get() >= 0 && look_at(file.get(), facts);
  const std::string text = good ? text_of(facts) : "";
  if (!good ||
      ::pwrite(file.get(), text.data(), text.size(), 0) != static_cast<::ssize_t>(text.size()))
    throw_file_error("write", path, errno);
}

std::string seal_problem(const std::string& path) {
  const Opened file(path, O_RDONLY);
  struct stat status {};
  if (file.get() < 0 || ::fstat(file.get(), &status) != 0 || !S_ISREG(status.st_mode)) return {};
  if (status.st_size == 0) return "is empty";
  std::string text(seal_size, '\0');
  const ::ssize_t there = ::pread(file.get(), text.data(), text.size(), 0);
  if (there < 0) return std::string("cannot be read: ") + std::strerror(errno);
  text.resize(static_cast<std::size_t>(there));
  if (!text.starts_with(first_line))
    return "is no checkpoint of this version of floe, or damaged at its beginning";
  Facts said, is;
  const int found = std::sscanf(text.c_str() + first_line.size(), "size %llu\ncrc32 %lx\n",
                                &said.size, &said.sum);
  const auto size = static_cast<unsigned long long>(status.st_size);
  if (found == 2 && said.size != size)
    return "is damaged: it has " + std::to_string(size) + " bytes, not " +
           std::to_string(said.size);
  if (found != 2 || text != text_of(said)) return "is damaged: its seal is broken";
  if (!look_at(file.get(), is)) return std::string("cannot be read: ") + std::strerror(errno);
  return is.sum == said.sum ? "" : "is damaged: its checksum is not that of its contents";
}

}  // namespace floe
