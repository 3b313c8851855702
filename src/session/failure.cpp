#include "session/failure.h"

#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <functional>
#include <memory>
#include <stdexcept>
#include <utility>
#include <vector>

#include "files/run_log.h"
#include "floe/base/petsc.h"
#include "floe/files/log.h"
#include "floe/session/session.h"
#include "session/launcher.h"
#include "session/run_place.h"

namespace floe {
namespace {

struct Words {
  const LastWords* owner;
  std::function<void(const std::string&)> words;
  LastWords::InCrash in_crash;
};
/// In the order in which they were set.
std::vector<Words>& last_words() {
  static std::vector<Words> words;
  return words;
}

/// A communicator for failures only, so that no other collective call can match the barrier in
/// all_ranks_are_here(); null on one rank.
MPI_Comm failures = MPI_COMM_NULL;  // NOLINT: as MPI_COMM_WORLD

/// Freed when memory has run out, so that the message can still be built.
std::unique_ptr<char[]>& reserve() {     // NOLINT: bytes
  static std::unique_ptr<char[]> bytes;  // NOLINT
  return bytes;
}

int rank_of_world() {
  int running = 0, ended = 0, me = 0;
  MPI_Initialized(&running);
  MPI_Finalized(&ended);
  if (running != 0 && ended == 0) MPI_Comm_rank(MPI_COMM_WORLD, &me);
  return me;
}

void report_mpi_error(MPI_Comm*, int* code, ...) {  // NOLINT: MPI's form
  std::array<char, MPI_MAX_ERROR_STRING> text{};
  int length = 0;
  MPI_Error_string(*code, text.data(), &length);
  leave("MPI: " + std::string(text.data()), exit_failed);
}

}  // namespace

LastWords::LastWords(std::function<void(const std::string&)> words, InCrash in_crash) {
  last_words().push_back({this, std::move(words), std::move(in_crash)});
}
LastWords::~LastWords() {
  std::erase_if(last_words(), [this](const Words& words) { return words.owner == this; });
}

void say_last_words(const std::string& why) noexcept {
  const auto all = std::exchange(last_words(), {});
  for (const Words& one : all) {
    try {
      one.words(why);
    } catch (...) {  // NOLINT: a failure here has no remedy
    }
  }
}

void say_last_words_in_crash(const char* why) noexcept {
  bool all_done = true;
  for (const Words& one : last_words()) all_done = one.in_crash && one.in_crash(why) && all_done;
  if (!all_done) say_last_words(why);
}

void end_at_once(int code) {
  std::fflush(nullptr);
  int running = 0, ended = 0, ranks = 1;
  MPI_Initialized(&running);
  MPI_Finalized(&ended);
  if (running != 0 && ended == 0) MPI_Comm_size(MPI_COMM_WORLD, &ranks);
  // MPI_Abort prints eight lines, and with one process there is no other rank to end.
  if (ranks > 1) MPI_Abort(MPI_COMM_WORLD, code);
  std::_Exit(code);
}

void leave(const std::string& line, int code) {
  if (code == exit_bad_input) drop_petsc_files();
  if (rank_of_world() > 0) {
    ::signal(SIGTERM, SIG_DFL);  // the launcher's signal once rank 0 has aborted
    ::sleep(2);
  }
  print_error("floe: " + line + "\n");
  run_place().code = code;
  say_last_words(line);
  end_at_once(code);
}

std::string out_of_memory_text() {
  reserve().reset();
  std::string text = "out of memory: this process has held up to " +
                     std::to_string(static_cast<long>(peak_memory_mb())) + " MB";
  rlimit limit{};
  if (getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY)
    text += "; its address space is limited to " + std::to_string(limit.rlim_cur >> 20) +
            " MB (ulimit -v)";
  return text;
}

void report_uncaught() {
  const std::exception_ptr error = std::current_exception();
  if (error == nullptr) leave("internal error: unknown error", exit_failed);
  try {
    std::rethrow_exception(error);
  } catch (const std::bad_alloc&) {
    leave(out_of_memory_text(), exit_failed);
  } catch (const FileError& e) {
    leave(e.what(), exit_failed);
  } catch (const InputError& e) {  // from a callback of PETSc
    leave(e.what(), exit_bad_input);
  } catch (const RunFailed& e) {
    leave(e.what(), exit_failed);
  } catch (const OptionFailed& e) {
    leave(e.what(), exit_failed);
  } catch (const std::exception& e) {
    leave(std::string("internal error: ") + e.what(), exit_failed);
  } catch (...) {
    leave("internal error: unknown error", exit_failed);
  }
}

void report_mpi_errors() {
  constexpr std::size_t enough = 1U << 18;
  reserve() = std::make_unique<char[]>(enough);  // NOLINT
  for (const MPI_Comm comm : {MPI_COMM_WORLD, MPI_COMM_SELF}) report_mpi_errors(comm);
}

void report_mpi_errors(MPI_Comm comm) {
  MPI_Errhandler handler = MPI_ERRHANDLER_NULL;
  MPI_Comm_create_errhandler(report_mpi_error, &handler);
  MPI_Comm_set_errhandler(comm, handler);
  MPI_Errhandler_free(&handler);
  if (failures == MPI_COMM_NULL && size(MPI_COMM_WORLD) > 1)
    MPI_Comm_dup(MPI_COMM_WORLD, &failures);
}

void forget_mpi() {
  if (failures != MPI_COMM_NULL) MPI_Comm_free(&failures);
}

bool all_ranks_are_here() {
  if (failures == MPI_COMM_NULL) return true;
  constexpr double patience = 10;  // [s]
  constexpr ::useconds_t nap = 10'000;
  MPI_Request request = MPI_REQUEST_NULL;
  MPI_Ibarrier(failures, &request);
  int here = 0;
  for (const double start = MPI_Wtime(); here == 0 && MPI_Wtime() - start < patience;) {
    MPI_Test(&request, &here, MPI_STATUS_IGNORE);
    if (here == 0) ::usleep(nap);
  }
  return here != 0;
}

}  // namespace floe
