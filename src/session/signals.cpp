#include "session/signals.h"

#include <array>
#include <csignal>

#include "base/collectives.h"

namespace floe {
namespace {

volatile std::sig_atomic_t signal_came = 0;  // NOLINT: a handler can reach no other object

void note_signal(int) { signal_came = 1; }

constexpr std::array asking{SIGTERM, SIGINT, SIGHUP, SIGUSR1, SIGUSR2, SIGXCPU};
constexpr std::array unwanted{SIGPIPE, SIGXFSZ};

using Actions = std::array<struct sigaction, asking.size() + unwanted.size()>;
Actions& earlier() {
  static Actions actions{};
  return actions;
}

void handle(int signal, void (*handler)(int)) {
  struct sigaction action {};
  action.sa_handler = handler;
  action.sa_flags = SA_RESTART;
  sigemptyset(&action.sa_mask);
  sigaction(signal, &action, nullptr);
}

}  // namespace

StopSignals::StopSignals() {
  signal_came = 0;
  std::size_t k = 0;
  for (const int signal : asking) sigaction(signal, nullptr, &earlier()[k++]);
  for (const int signal : unwanted) sigaction(signal, nullptr, &earlier()[k++]);
  arm();
}

void StopSignals::arm() {
  for (std::size_t k = 0; k < asking.size(); ++k)
    handle(asking[k], earlier()[k].sa_handler == SIG_IGN ? SIG_IGN : note_signal);
  for (const int signal : unwanted) handle(signal, SIG_IGN);
}

StopSignals::~StopSignals() {
  std::size_t k = 0;
  for (const int signal : asking) sigaction(signal, &earlier()[k++], nullptr);
  for (const int signal : unwanted) sigaction(signal, &earlier()[k++], nullptr);
}

bool StopSignals::came() { return signal_came != 0; }

bool StopSignals::came(MPI_Comm comm) { return on_any_rank(signal_came != 0, comm); }

void stop_if_asked(MPI_Comm comm) {
  if (StopSignals::came(comm))
    throw Stopped("stopped on request before the first state; nothing has been written");
}

}  // namespace floe
