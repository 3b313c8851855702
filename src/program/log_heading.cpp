#include "log_heading.h"

#include <unistd.h>

#include <filesystem>

#include "files/files.h"
#include "floe/base/petsc.h"
#include "floe/session/version.h"
#include "go_on.h"

namespace floe::program {

std::string log_heading(int argc, const char* const* argv) {
  std::string command;
  for (int k = 0; k < argc; ++k) command += (k > 0 ? " " : "") + shell_word(argv[k]);
  std::error_code ignored;
  const int ranks = size(MPI_COMM_WORLD);
  return "floe " + version() + ", " + date_and_time() + "\ncommand: " + command +
         "\nfolder: " + std::filesystem::current_path(ignored).string() + "\nhost: " + host_name() +
         ", process " + std::to_string(::getpid()) + ", " + std::to_string(ranks) +
         (ranks == 1 ? " rank" : " ranks") + ", library for " + built_for() + "\n";
}

}  // namespace floe::program
