// A crash ends a run with one line instead of a page of traces.
#include <signal.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <cstring>
#include <string_view>

#include "files/run_log.h"
#include "floe/base/petsc.h"
#include "floe/session/session.h"
#include "session/blame.h"
#include "session/failure.h"
#include "session/run_place.h"

namespace floe {
namespace {

constexpr std::array crashes{SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT};

const char* name_of(int signal) {
  switch (signal) {
    case SIGSEGV:
      return "segmentation fault";
    case SIGBUS:
      return "bus error";
    case SIGFPE:
      return "arithmetic exception";
    case SIGILL:
      return "illegal instruction (was floe built for this processor?)";
    default:
      return "aborted by a library";
  }
}

void put(const char* text) {
  (void)!::write(STDERR_FILENO, text, std::strlen(text));
  put_into_log(text);
}

/// The end of a process whose last words hang or crash.
void end_without_words(int) {
  const int code = run_place().code;
  ::_exit(code == 0 ? exit_failed : code);
}

void handle_crash(int signal) { end_crashed(name_of(signal)); }

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool sanitized = true;
#elif defined(__has_feature)
constexpr bool sanitized = __has_feature(address_sanitizer) || __has_feature(thread_sanitizer);
#else
constexpr bool sanitized = false;
#endif

}  // namespace

RunPlace& run_place() {
  static RunPlace place;
  return place;
}

void end_crashed(const char* what) noexcept {
  // A second crash, inside this function or in another thread, ends the process too.
  for (const int signal : crashes) ::signal(signal, end_without_words);
  // The crash may have been in the allocator, so the code after the printed line may hang. On a
  // machine that is busy with other things that code takes its time, so this is long.
  constexpr unsigned patience = 60;  // [s]
  ::signal(SIGALRM, end_without_words);
  ::alarm(patience);
  std::array<char, 2000> line{};
  int code = exit_failed;
  if (const char* blame = blame_for_a_crash(); *blame != '\0') {
    std::snprintf(line.data(), line.size(), "%s (%s)", blame, what);
    code = exit_bad_input;
  } else {
    const RunPlace& place = run_place();
    std::array<char, 100> when{};
    if (place.step >= 0) {
      std::snprintf(when.data(), when.size(), "after time %g, step %lld", place.time,
                    static_cast<long long>(place.step));
    } else {
      std::snprintf(when.data(), when.size(), "%s", place.stage);
    }
    std::snprintf(line.data(), line.size(),
                  "crashed %s: %s; this is an error in floe or in a library: please report it to "
                  "floe's developers, with the scene, floe.log and what floe --version says",
                  when.data(), what);
  }
  put("floe: ");
  put(line.data());
  put("\n");
  run_place().code = code;
  say_last_words_in_crash(line.data());
  if (code == exit_bad_input) drop_petsc_files();
  end_at_once(code);
}

void leave_crashes_to_the_system() {
  if (sanitized) return;
  for (const int signal : crashes) ::signal(signal, SIG_DFL);
}

void report_crashes() {
  if (sanitized) return;
  constexpr std::size_t room = 1U << 18;
  static std::array<char, room> stack;  // the crash may be a stack overflow
  stack_t other{};
  other.ss_sp = stack.data();
  other.ss_size = stack.size();
  sigaltstack(&other, nullptr);
  struct sigaction action {};
  action.sa_handler = handle_crash;
  action.sa_flags = static_cast<int>(SA_ONSTACK | SA_NODEFER);
  sigemptyset(&action.sa_mask);
  for (const int signal : crashes) sigaction(signal, &action, nullptr);
}

}  // namespace floe
