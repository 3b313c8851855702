#include "floe/base/petsc.h"

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <optional>
#include <string>

#include "floe/base/options.h"
#include "option_names.h"
#include "solver_options.h"

namespace floe {
namespace {

/// PETSc's own words for the last error, kept for fail(); PETSc's default handler would print a
/// page.
std::string
    last_message;  // NOLINT: written by PETSc's error handler, which has no other place to put it

PetscErrorCode remember_error(MPI_Comm, int, const char*, const char*, PetscErrorCode code,
                              PetscErrorType type, const char* message, void*) {
  if (type == PETSC_ERROR_INITIAL) last_message = message ? message : "";
  return code;
}

/// Whether somebody else started this process as one of several, or may have: mpiexec, srun.
bool has_launcher() {
  for (const char* name :
       {"OMPI_COMM_WORLD_SIZE", "PMIX_RANK", "PMI_RANK", "PMI_FD", "SLURM_PROCID"})
    if (std::getenv(name) != nullptr) return true;
  return false;
}

/// Tells Open MPI what one process does without; what the user has set stands, but for the
/// yielding.
void prepare_one_process() {
  // MUMPS asks MPI for messages all the time. One process has nobody to give way to; told to yield
  // (tools/env), it would hand each of its time slices to whatever else the machine runs.
  const char* size = std::getenv("OMPI_COMM_WORLD_SIZE");
  if (size == nullptr || std::strcmp(size, "1") == 0)
    setenv("OMPI_MCA_mpi_yield_when_idle", "0", 1);
  if (has_launcher()) return;
  // No daemon that could start further processes and no search for networks: 0.1 s instead of 0.5.
  // No session folder either: those that start at the same time would share it, and one in 40
  // aborted when another had removed it.
  setenv("OMPI_MCA_ess_singleton_isolated", "1", 0);
  setenv("OMPI_MCA_orte_create_session_dirs", "0", 0);
  setenv("OMPI_MCA_pml", "ob1", 0);
  setenv("OMPI_MCA_btl", "self", 0);
}

std::function<void(const std::string&)>& last_words() {
  static std::function<void(const std::string&)> words;
  return words;
}

bool& gave_up() {
  static bool yes = false;
  return yes;
}

/// MPI_Abort prints eight lines of its own; a process that started alone has nobody to tell.
[[noreturn]] void end_at_once() {
  std::fflush(nullptr);
  int running = 0;
  MPI_Initialized(&running);
  if (running && has_launcher()) MPI_Abort(MPI_COMM_WORLD, 1);
  std::_Exit(1);
}

[[noreturn]] void report_and_abort() {
  const char* what = "unknown error";
  const char* kind = "internal error: ";
  std::string text;
  if (const auto error = std::current_exception()) {
    try {
      std::rethrow_exception(error);
    } catch (const FileError& e) {
      text = e.what();
      what = text.c_str();
      kind = "";
    } catch (const std::exception& e) {
      text = e.what();
      what = text.c_str();
    } catch (...) {
    }
  }
  std::fprintf(stderr, "floe: %s%s\n", kind, what);
  std::fflush(stderr);
  if (last_words()) last_words()(std::string(kind) + what);
  end_at_once();
}

}  // namespace

void fail(int ierr, const std::source_location& where) {
  const char* generic = nullptr;
  PetscErrorMessage(ierr, &generic, nullptr);
  std::string text = last_message.empty() ? std::string(generic ? generic : "") : last_message;
  while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) text.pop_back();
  last_message.clear();
  const bool not_a_number = ierr == PETSC_ERR_ARG_OUTOFRANGE && text.rfind("Input string", 0) == 0;
  const bool not_in_list = ierr == PETSC_ERR_USER && text.rfind("Unknown option", 0) == 0;
  if (ierr == PETSC_ERR_ARG_UNKNOWN_TYPE || ierr == PETSC_ERR_USER_INPUT ||
      ierr == PETSC_ERR_MISSING_FACTOR || not_a_number || not_in_list) {
    for (char& c : text) {
      if (c == '\n') c = ' ';
    }
    throw InputError("solver option: " + text);
  }
  throw std::runtime_error(text + " (code " + std::to_string(ierr) + ", " + where.file_name() +
                           ":" + std::to_string(where.line()) + ")");
}

void set_last_words(std::function<void(const std::string&)> words) {
  last_words() = std::move(words);
}

Mpi::Mpi(int& argc, char**& argv) {
  std::set_terminate(report_and_abort);
  prepare_one_process();
  MPI_Init(&argc, &argv);
}

void give_up_on_mpi() { gave_up() = true; }

Mpi::~Mpi() {
  if (gave_up()) end_at_once();
  MPI_Finalize();
}

namespace {

/// A variable of the environment that is not there during this object's life.
class Without {
 public:
  explicit Without(const char* name) : name_(name) {
    if (const char* value = std::getenv(name)) value_ = value;
    unsetenv(name);
  }
  ~Without() {
    if (value_) setenv(name_, value_->c_str(), 1);
  }
  Without(const Without&) = delete;
  Without& operator=(const Without&) = delete;

 private:
  const char* name_;
  std::optional<std::string> value_;
};

/// Puts PETSc's options into its table, before PetscInitialize, which acts on some of them.
void put_petsc_options(const UserOptions& user) {
  constexpr int most = 400;  // PETSc 3.18 has room for 512
  int count = 0;
  std::string problem;
  for (const auto& [name, given] : user.merged()) {
    if (!is_petsc_option(name)) continue;
    if (given.source == Source::environment && !is_environment_option(name)) continue;
    if (problem.empty()) problem = solver_option_problem(name, given.value);
    if (++count > most)
      throw InputError(name + ": more than " + std::to_string(most) + " options of PETSc's");
    check(PetscOptionsSetValue(nullptr, ("-" + name).c_str(),
                               given.value.empty() ? nullptr : given.value.c_str()));
  }
  throw_verdict(problem, MPI_COMM_WORLD);
  check(PetscOptionsSetValue(nullptr, "-skip_petscrc", nullptr));
}

}  // namespace

Session::Session(const char* program, const UserOptions& user) : program_(program) {
  put_petsc_options(user);
  const Without options("PETSC_OPTIONS"), yaml("PETSC_OPTIONS_YAML");
  words_[0] = program_.data();
  word_ = words_.data();
  int count = 1;
  check(PetscInitialize(&count, &word_, nullptr, nullptr));
  check(PetscPushErrorHandler(remember_error, nullptr));
}

Session::~Session() {
  // PETSc lists options that nothing has asked for (from 3.19 on unasked), also where a run has
  // been refused. warn_unused_options() says so where it matters.
  PetscBool given = PETSC_FALSE;
  (void)PetscOptionsHasName(nullptr, nullptr, "-options_left", &given);
  if (given == PETSC_FALSE) (void)PetscOptionsSetValue(nullptr, "-options_left", "no");
  (void)PetscFinalize();
}

}  // namespace floe
