#include "options/text_file.h"

#include <sys/stat.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>

#include "base/collectives.h"
#include "base/on_root.h"

namespace floe {

std::string read_text_file(const std::string& what, const std::string& path, std::size_t most,
                           MPI_Comm comm,
                           const std::function<std::string(const std::string&)>& near_to) {
  const auto refuse = [&](const std::string& why) { throw InputError(what + ": " + why); };
  std::string all;
  on_root(comm, [&] {
    struct stat status {};
    if (stat(path.c_str(), &status) != 0) {
      const std::string why = std::strerror(errno);
      refuse(why + (near_to ? near_to(path) : ""));
    }
    if (!S_ISREG(status.st_mode))
      refuse(S_ISDIR(status.st_mode) ? "is a directory, not a file" : "is not a regular file");
    if (static_cast<std::size_t>(status.st_size) > most)
      refuse("has " + std::to_string(status.st_size) + " bytes, at most " + std::to_string(most) +
             " are read");
    std::ifstream file(path, std::ios::binary);
    if (!file) refuse(std::strerror(errno));
    std::ostringstream text;
    text << file.rdbuf();
    if (file.bad() || text.bad()) refuse("cannot be read");
    all = text.str();
  });
  broadcast(all, comm);
  return all;
}

}  // namespace floe
