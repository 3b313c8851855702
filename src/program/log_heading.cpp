#include "log_heading.h"

#include <unistd.h>

#include <cctype>
#include <filesystem>
#include <string_view>

#include "base/files.h"
#include "floe/base/petsc.h"
#include "floe/base/version.h"

namespace floe::program {
namespace {

/// Quotes a word for a shell.
std::string shell_word(std::string_view word) {
  bool plain = !word.empty();
  for (const char c : word)
    plain = plain && (std::isalnum(static_cast<unsigned char>(c)) != 0 ||
                      std::string_view("_-+=./:,@%").find(c) != std::string_view::npos);
  if (plain) return std::string(word);
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

}  // namespace

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
