#include "signals_at_start.h"

#include <csignal>

namespace floe::program {
namespace {

struct sigaction at_start {};
sigset_t mask_at_start;

/// SIGHUP waits until restore_signals().
void hold(int, char**, char**) {
  sigaction(SIGHUP, nullptr, &at_start);
  sigset_t hang_up;
  sigemptyset(&hang_up);
  sigaddset(&hang_up, SIGHUP);
  sigprocmask(SIG_BLOCK, &hang_up, &mask_at_start);
}

/// The loader calls what stands in this section of a program before libraries' constructors.
[[gnu::section(".preinit_array"), gnu::used]] void (*const before_libraries)(int, char**,
                                                                             char**) = hold;

}  // namespace

void restore_signals() {
  sigaction(SIGHUP, &at_start, nullptr);
  sigprocmask(SIG_SETMASK, &mask_at_start, nullptr);
}

}  // namespace floe::program
