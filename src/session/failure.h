/// \file
/// The end of a process after an uncaught error: one line, the entry in the run's folder, and an
/// exit code.
#pragma once

#include <mpi.h>

#include <stdexcept>
#include <string>

namespace floe {

constexpr int exit_failed = 1, exit_bad_input = 2;

/// An error of PETSc, after the first solve, that names an option.
class OptionFailed : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Prints one line on standard error and in the log, calls the last words, and ends all ranks.
/// Ranks other than 0 wait 2 s first: an error common to all ranks is printed by rank 0, which then
/// ends the others.
[[noreturn]] void leave(const std::string& line, int code);

/// Ends all ranks without a message.
[[noreturn]] void end_at_once(int code);

/// The terminate handler: reports the exception in flight and leaves.
[[noreturn]] void report_uncaught();

/// Calls all last words (LastWords), once.
void say_last_words(const std::string& why) noexcept;
/// Does the same in the handler of a crash: by system calls only, where that is all there is to do.
void say_last_words_in_crash(const char* why) noexcept;

/// Makes errors of MPI end the process with one line. Call after MPI_Init.
void report_mpi_errors();
/// The same for errors in calls on one communicator only.
void report_mpi_errors(MPI_Comm comm);
/// Frees the communicator for failures. Call before MPI_Finalize.
void forget_mpi();

/// Whether all ranks reach this call within 10 s. An error that all ranks met can be raised on all
/// of them; a rank that is later counts as one that did not meet the error.
bool all_ranks_are_here();

/// Returns "out of memory", with the peak memory of the process and its limit.
std::string out_of_memory_text();

/// Makes the signals of a crash (SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT) end the process with one
/// line, the last words, and exit code 1 (2 if an option of PETSc is to blame). Does nothing with
/// sanitizers, whose reports say more.
void report_crashes();
/// Restores the system's default action for these signals; does nothing with sanitizers.
void leave_crashes_to_the_system();
/// Ends the process after a crash, as report_crashes() describes.
/// \param what  name of the crash, for example "segmentation fault"
[[noreturn]] void end_crashed(const char* what) noexcept;

}  // namespace floe
