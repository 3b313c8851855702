#include "floe/files/log.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <string>

#include "base/collectives.h"
#include "files/run_log.h"
#include "floe/base/petsc.h"
#include "floe/files/progress.h"

namespace floe {
namespace {

// Progress: time before the first line, and least times between updates of a terminal's bar and
// between other lines [s].
constexpr double quiet_seconds = 1, bar_seconds = 0.2, line_seconds = 5;

constexpr int number_of_events = static_cast<int>(Event::count);

std::array<double, number_of_events>& totals() {
  static std::array<double, number_of_events> seconds{};
  return seconds;
}

PetscLogEvent petsc_event(Event event) {
  static const auto registered = [] {
    std::array<PetscLogEvent, number_of_events> ids{};
    PetscClassId floe_class = 0;
    check(PetscClassIdRegister("Floe", &floe_class));
    for (int k = 0; k < number_of_events; ++k)
      check(PetscLogEventRegister(event_names[static_cast<std::size_t>(k)].data(), floe_class,
                                  &ids[static_cast<std::size_t>(k)]));
    return ids;
  }();
  return registered[static_cast<std::size_t>(event)];
}

}  // namespace

Timed::Timed(Event event) : event_(event), start_(MPI_Wtime()) {
  check(PetscLogEventBegin(petsc_event(event_), 0, 0, 0, 0));
}

Timed::~Timed() {
  (void)PetscLogEventEnd(petsc_event(event_), 0, 0, 0, 0);
  totals()[static_cast<std::size_t>(event_)] += MPI_Wtime() - start_;
}

double wall_seconds(Event event) { return totals()[static_cast<std::size_t>(event)]; }

double peak_memory_mb() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;  // Linux counts in KiB
}

double resident_memory_mb(MPI_Comm comm) {
  double mine = 0;
  if (std::FILE* file = std::fopen("/proc/self/statm", "r")) {
    long whole = 0, resident = 0;
    if (std::fscanf(file, "%ld %ld", &whole, &resident) == 2)
      mine = static_cast<double>(resident) * static_cast<double>(sysconf(_SC_PAGESIZE)) / 1e6;
    std::fclose(file);
  }
  return sum_over_ranks(mine, comm);
}

namespace {

bool shows_progress = true;  // NOLINT: as standard error itself

}  // namespace

void show_progress(bool yes) { shows_progress = yes; }

Progress::Progress(std::string_view what, double total)
    : what_(what), total_(total), start_(MPI_Wtime()), last_print_(start_), last_logged_(start_) {
  active_ = shows_progress && rank() == 0;
  terminal_ = isatty(STDERR_FILENO) != 0;
}

void warn(const std::string& text) {
  // Erases a progress bar in the present line.
  if (isatty(STDERR_FILENO) != 0) std::fputs("\r\033[K", stderr);
  print_error("floe: warning: " + text + "\n");
}

Progress::~Progress() {
  if (shown_ && terminal_) std::fprintf(stderr, "\r\033[K");
}

void Progress::update(double done, std::string_view note) {
  if (!active_) return;
  const double now = MPI_Wtime();
  if (announced_ > 0) took_ = now - announced_;
  announced_ = 0;
  if (now - start_ < quiet_seconds) return;
  if (now - last_print_ < (terminal_ ? bar_seconds : line_seconds)) return;
  print(done, note, now);
}

void Progress::announce(double done, std::string_view note, double seconds) {
  update(done, note);
  if (!active_) return;
  announced_ = MPI_Wtime();
  const double expected = took_ > 0 ? took_ : seconds;
  if (expected < line_seconds) return;
  std::array<char, 32> time{};
  std::snprintf(time.data(), time.size(), ", about %.2g s", expected);
  print(done, std::string(note) + time.data(), announced_);
}

void Progress::print(double done, std::string_view note, double now) {
  last_print_ = now;
  shown_ = true;
  std::string plain = std::string(what_) + ": ", drawn = plain;
  if (total_ > 0) {
    const double share = std::clamp(done / total_, 0.0, 1.0);
    std::array<char, 32> left{};
    if (share > 0 && share < 1)
      std::snprintf(left.data(), left.size(), ", %.0f s left",
                    (now - start_) * (1 - share) / share);
    constexpr int bar_width = 30;
    const auto full = static_cast<std::size_t>(share * bar_width);
    std::array<char, 80> text{};
    std::snprintf(text.data(), text.size(), "%.0f %%%s  ", 100 * share, left.data());
    plain += text.data();
    std::snprintf(text.data(), text.size(), "] %3.0f %%%s  ", 100 * share, left.data());
    drawn = std::string(what_) + " [" + std::string(full, '#') +
            std::string(bar_width - full, '.') + text.data();
  }
  plain += std::string(note) + "\n";
  drawn = "\r\033[K" + drawn + std::string(note);
  std::fputs(terminal_ ? drawn.c_str() : plain.c_str(), stderr);
  std::fflush(stderr);
  constexpr double seldom = 60;  // [s], to keep the log of a run of weeks short
  if (now - last_logged_ < seldom) return;
  last_logged_ = now;
  put_into_log(plain);
}

}  // namespace floe
