/// \file
/// How a process ends on what nobody catches: one line, what the run's folder should say, and an
/// exit code.
#pragma once

#include <new>
#include <stdexcept>
#include <string>

namespace floe {

constexpr int exit_failed = 1, exit_bad_input = 2;

/// Archive that PETSc or a solver behind it asked for and did not get.
class OutOfMemory : public std::bad_alloc {};

/// What PETSc says of an option after the first solve.
class OptionFailed : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// One line on standard error and in the log, the last words, and the end of all ranks. A rank that
/// is not the first waits: what all ranks have met is rank 0's to say, and it ends the others.
[[noreturn]] void leave(const std::string& line, int code);

/// The end of all ranks without a word.
[[noreturn]] void end_at_once(int code);

/// The terminate handler: tells what is in flight, and leaves.
[[noreturn]] void report_uncaught();

/// What the last words have been set to, if anything.
void say_last_words(const std::string& why) noexcept;

/// Errors of MPI's own end the process with one line; after MPI_Init.
void report_mpi_errors();
/// Before MPI_Finalize.
void forget_mpi();

/// Whether all ranks come here too: an error that all have met can be raised on all. A rank that is
/// a good deal later is taken not to come.
bool all_ranks_are_here();

/// "out of memory", with how much the process holds and what limits it.
std::string out_of_memory_text();

/// Signals of a crash (SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT) end the process with one line, the
/// last words, and exit code 1 (2 if an option of PETSc's is to blame). Not with sanitizers, which
/// say more.
void report_crashes();
void leave_crashes_to_the_system();
/// What report_crashes() does at a crash; `what` is "segmentation fault".
[[noreturn]] void end_crashed(const char* what) noexcept;

}  // namespace floe
