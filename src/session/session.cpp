#include "floe/session/session.h"
#include "floe/session/solver_options.h"

#include <algorithm>
#include <array>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <optional>
#include <string>

#include "files/run_log.h"
#include "floe/base/petsc.h"
#include "floe/options/options.h"
#include "options/option_names.h"
#include "session/blame.h"
#include "session/failure.h"
#include "session/launcher.h"
#include "session/petsc_files.h"
#include "session/solver_options.h"

namespace floe {
namespace {

/// Throws for errors of PETSc that an option caused: InputError before the first solve and where
/// PETSc lacks what an option asks for, OptionFailed later.
void throw_known_failure(int ierr, const std::string& petsc_says) {
  if (solver_options_are_doubtful()) {
    const std::string line = blame_solver_options(petsc_says);
    if (!all_ranks_are_here()) leave(line, exit_bad_input);
    throw InputError(line);
  }
  const bool not_a_number =
      ierr == PETSC_ERR_ARG_OUTOFRANGE && petsc_says.starts_with("Input string");
  const bool not_in_list = ierr == PETSC_ERR_USER && petsc_says.starts_with("Unknown option");
  if (ierr == PETSC_ERR_ARG_UNKNOWN_TYPE || ierr == PETSC_ERR_USER_INPUT ||
      ierr == PETSC_ERR_MISSING_FACTOR || not_a_number || not_in_list)
    throw InputError("solver option: " + petsc_says);
  const std::string option = solver_option_named(petsc_says);
  if (!option.empty()) throw OptionFailed(option + ": PETSc cannot take it: " + petsc_says);
}

}  // namespace

Mpi::Mpi(int& argc, char**& argv) {
  std::set_terminate(report_uncaught);
  set_failure_handler(throw_known_failure);
  prepare_one_process();
  report_crashes();
  MPI_Init(&argc, &argv);
  if (size(MPI_COMM_WORLD) > 1) ask_for_short_turns();
  report_crashes();  // MPI_Init has installed handlers of its own
  report_mpi_errors();
}

Mpi::Mpi(Guest) {
  std::set_terminate(report_uncaught);  // of what a callback of PETSc lets through
  set_failure_handler(throw_known_failure);
  int running = 0;
  MPI_Initialized(&running);
  is_ours_ = running == 0;
  if (is_ours_) {
    prepare_one_process();
    MPI_Init(nullptr, nullptr);
    if (size(MPI_COMM_WORLD) > 1) ask_for_short_turns();
  }
  MPI_Comm_dup(MPI_COMM_WORLD, &messages_);
  report_mpi_errors(messages_);
  PETSC_COMM_WORLD = messages_;
}

Mpi::~Mpi() {
  if (mpi_is_given_up()) end_at_once(exit_failed);
  forget_mpi();
  if (messages_ != MPI_COMM_NULL) {
    int ended = 0;
    MPI_Finalized(&ended);
    if (ended != 0) return;
    MPI_Comm_free(&messages_);
    PETSC_COMM_WORLD = MPI_COMM_NULL;
  }
  if (is_ours_) MPI_Finalize();
}

namespace {

/// Removes a variable of the environment during this object's life.
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

/// Puts PETSc's options into a table of PETSc; null: the process's, before PetscInitialize, which
/// acts on some of them.
/// \return the options in the table
/// \throws InputError for more than 400 options or a refused value
GivenOptions put_petsc_options(const UserOptions& user, PetscOptions table) {
  constexpr std::size_t most = 400;  // PETSc 3.18 holds at most 512
  GivenOptions put;
  std::string problem;
  for (const auto& [name, given] : user.merged()) {
    if (!is_petsc_option(name)) continue;
    if (given.source == Source::environment && !is_environment_option(name)) continue;
    put[name] = given;
    if (put.size() > most)
      throw InputError(name + ": more than " + std::to_string(most) + " options of PETSc's");
    check(PetscOptionsSetValue(table, ("-" + name).c_str(),
                               given.value.empty() ? nullptr : given.value.c_str()));
  }
  for (const auto& [name, given] : put) {
    if (problem.empty()) problem = solver_option_problem(name, given.value);
    if (problem.empty()) problem = petsc_file_problem(name, given.value, put);
  }
  throw_verdict(problem, MPI_COMM_WORLD);
  note_petsc_files(put);
  return put;
}

/// Whether the options request a debugger or PETSc's traces, for which PETSc must handle errors.
bool wants_petsc_handlers(const GivenOptions& options) {
  return std::any_of(options.begin(), options.end(), [](const auto& option) {
    const std::string& name = option.first;
    return name.starts_with("on_error_") || name == "start_in_debugger" ||
           name == "stop_for_debugger";
  });
}

decltype(PetscVFPrintf) print_by_petsc = nullptr;  // NOLINT: like PETSc's own pointer

/// Copies to the log what PETSc prints on standard output and error.
PetscErrorCode print_for_petsc(std::FILE* file, const char* format, std::va_list words) noexcept {
  if (file == stdout || file == stderr) {
    std::array<char, 8192> text{};
    std::va_list again;
    va_copy(again, words);
    std::size_t length = 0;
    if (PetscVSNPrintf(text.data(), text.size(), format, &length, again) == 0)
      put_into_log(text.data());
    va_end(again);
  }
  return print_by_petsc(file, format, words);
}

}  // namespace

Session::Session(const char* program, const UserOptions& user, bool handles_crashes)
    : program_(program) {
  const GivenOptions options = put_petsc_options(user, nullptr);
  check(PetscOptionsSetValue(nullptr, "-skip_petscrc", nullptr));
  const bool by_petsc = wants_petsc_handlers(options);
  const bool by_system = options.contains("no_signal_handler") || !handles_crashes;
  if (!handles_crashes) check(PetscOptionsSetValue(nullptr, "-no_signal_handler", nullptr));
  set_solver_options(options);
  const Without variable("PETSC_OPTIONS"), yaml("PETSC_OPTIONS_YAML");
  words_[0] = program_.data();
  word_ = words_.data();
  int count = 1;
  if (handles_crashes && (by_petsc || by_system)) leave_crashes_to_the_system();
  // Before PetscInitialize, which reads options and whose own handler prints a page. A handler that
  // -on_error_... names is put on top of this one.
  keep_petsc_messages();
  check(PetscInitialize(&count, &word_, nullptr, nullptr));
  if (!by_petsc && !by_system) report_crashes();  // PETSc has installed handlers of its own
  if (print_by_petsc == nullptr) {
    print_by_petsc = PetscVFPrintf;
    PetscVFPrintf = print_for_petsc;
  }
}

Session::~Session() {
  // PETSc would list options that were never queried (since 3.19 by default), even after a run was
  // refused. warn_unused_options() reports them where they matter.
  PetscBool given = PETSC_FALSE;
  (void)PetscOptionsHasName(nullptr, nullptr, "-options_left", &given);
  if (given == PETSC_FALSE) (void)PetscOptionsSetValue(nullptr, "-options_left", "no");
  (void)PetscFinalize();
}

/// Whether PETSc acts on an option at its start or end only.
bool is_of_the_process(std::string_view name) {
  constexpr std::array words{"citations",         "get_total_flops",  "mpidump",    "objects_dump",
                             "no_signal_handler", "stack_view",       "checkstack", "info",
                             "start_in_debugger", "stop_for_debugger"};
  constexpr std::array families{"log_", "malloc", "on_error_", "fp_", "options_", "memory_"};
  const auto begins = [&](const char* family) { return name.starts_with(family); };
  return std::find(words.begin(), words.end(), name) != words.end() ||
         std::any_of(families.begin(), families.end(), begins);
}

SolverOptions::SolverOptions(const UserOptions& user) {
  UserOptions taken = user;
  for (GivenOptions* from : {&taken.environment, &taken.checkpoint})
    std::erase_if(*from, [](const auto& option) { return is_of_the_process(option.first); });
  for (const auto& [name, given] : taken.merged()) {
    if (is_petsc_option(name) && is_of_the_process(name))
      throw InputError(name +
                       ": PETSc takes it once in a process, at its start: the program floe "
                       "has it");
  }
  PetscOptions table = nullptr;
  check(PetscOptionsCreate(&table));
  table_ = table;
  try {
    given_ = put_petsc_options(taken, table);
  } catch (...) {
    (void)PetscOptionsDestroy(&table);
    throw;
  }
  good_ = given_.empty();
}

SolverOptions::~SolverOptions() {
  auto table = static_cast<PetscOptions>(table_);
  int ended = 0;
  MPI_Finalized(&ended);
  if (ended == 0) (void)PetscOptionsDestroy(&table);
}

SolverOptions::Use::Use(SolverOptions& options) : options_(options) {
  set_solver_options(options.given_);
  if (options.good_) solver_options_are_good();
  check(PetscOptionsPush(static_cast<PetscOptions>(options.table_)));
}

SolverOptions::Use::~Use() {
  (void)PetscOptionsPop();
  options_.good_ = !solver_options_are_doubtful();
  set_solver_options({});
}

}  // namespace floe
