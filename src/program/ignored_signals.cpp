#include "ignored_signals.h"

#include <csignal>

namespace floe::program {
namespace {

std::uint64_t ignored = 0;

void look(int, char**, char**) {
  constexpr int most = 31;  // those with names
  for (int signal = 1; signal <= most; ++signal) {
    struct sigaction action {};
    if (sigaction(signal, nullptr, &action) == 0 && action.sa_handler == SIG_IGN)
      ignored |= std::uint64_t{1} << signal;
  }
}

/// The loader calls what stands in this section of a program before libraries' constructors.
[[gnu::section(".preinit_array"), gnu::used]] void (*const at_start)(int, char**, char**) = look;

}  // namespace

std::uint64_t ignored_at_start() { return ignored; }

}  // namespace floe::program
