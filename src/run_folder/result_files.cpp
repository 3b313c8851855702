#include "run_folder/result_files.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "floe/base/petsc.h"

namespace floe {
namespace {

std::string kind_of(::mode_t mode) {
  if (S_ISDIR(mode)) return "a folder";
  if (S_ISREG(mode)) return "a file";
  if (S_ISFIFO(mode)) return "a pipe";
  if (S_ISSOCK(mode)) return "a socket";
  return "a device";
}

bool may(const std::string& path, int what) {
  return ::faccessat(AT_FDCWD, path.c_str(), what, AT_EACCESS) == 0;
}

enum class Entry { file, folder };

/// Returns why a run cannot have `path` for itself; empty if it can, or if there is no such path.
std::string problem_of(const std::string& path, Entry entry) {
  struct stat link {
  }, there{};
  if (::lstat(path.c_str(), &link) != 0) return {};
  const bool is_link = S_ISLNK(link.st_mode);
  if (::stat(path.c_str(), &there) != 0)
    return is_link ? std::string("is a link that leads nowhere") : std::strerror(errno);
  const bool fits = entry == Entry::folder ? S_ISDIR(there.st_mode) : S_ISREG(there.st_mode);
  if (!fits) return (is_link ? "is a link to " : "is ") + kind_of(there.st_mode);
  if (!may(path, entry == Entry::folder ? W_OK | X_OK : W_OK))
    return std::string("may not be changed: ") + std::strerror(errno);
  return {};
}

}  // namespace

void check_result_files(const std::string& dir, std::span<const std::string_view> names) {
  const auto require = [&](const std::string& name, Entry entry) {
    const std::string problem = problem_of(dir + "/" + name, entry);
    if (!problem.empty())
      throw InputError("output: dir: '" + dir + "' cannot be used: its " + name + " " + problem +
                       ", a run needs the name for a " +
                       (entry == Entry::folder ? "folder" : "file") +
                       " of its own; remove it, or give another -output_dir");
  };
  for (const std::string_view name : names) require(std::string(name), Entry::file);
  require("fields", Entry::folder);
}

}  // namespace floe
