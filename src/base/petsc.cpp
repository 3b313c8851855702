#include "floe/base/petsc.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <optional>
#include <string>
#include <string_view>

#include "files/run_log.h"
#include "session/blame.h"
#include "session/failure.h"
#include "floe/options/options.h"
#include "session/launcher.h"
#include "options/option_names.h"
#include "session/petsc_files.h"
#include "session/solver_options.h"

namespace floe {
namespace {

/// PETSc's message for the last error, kept for fail(); PETSc's default handler would print a page.
std::string last_message;  // NOLINT: PETSc's error handler has no other place for its message

PetscErrorCode remember_error(MPI_Comm, int, const char* function, const char*, PetscErrorCode code,
                              PetscErrorType type, const char* message, void*) {
  // For memory that it could not allocate, PETSc 3.18 (PetscMallocAlign) passes the caller's line
  // in place of the error's code.
  if (function != nullptr && std::string_view(function) == "PetscMallocAlign") code = PETSC_ERR_MEM;
  if (type == PETSC_ERROR_INITIAL) last_message = message ? message : "";
  return code;
}

bool& gave_up() {
  static bool yes = false;
  return yes;
}

/// Returns PETSc's message for the last error, in one line, and clears it.
std::string take_last_message(int ierr) {
  const char* generic = nullptr;
  PetscErrorMessage(ierr, &generic, nullptr);
  std::string text = last_message.empty() ? std::string(generic ? generic : "") : last_message;
  last_message.clear();
  for (char& c : text) {
    if (std::iscntrl(static_cast<unsigned char>(c)) != 0) c = ' ';
  }
  while (!text.empty() && text.back() == ' ') text.pop_back();
  constexpr std::size_t longest = 200;  // it may quote a value
  return text.size() > longest ? text.substr(0, longest) + "..." : text;
}

/// Whether an error means that memory ran out. MUMPS reports this by a number (INFOG(1), see the
/// users' guide of MUMPS).
bool is_out_of_memory(int ierr, const std::string& text) {
  return ierr == PETSC_ERR_MEM || text.find("INFOG(1)=-13") != std::string::npos ||
         text.find("Cannot allocate required memory") != std::string::npos;
}

}  // namespace

void fail(int ierr, const std::source_location& where) {
  const std::string text = take_last_message(ierr);
  if (is_out_of_memory(ierr, text)) throw OutOfMemory();
  if (solver_options_are_doubtful()) {
    const std::string line = blame_solver_options(text);
    if (!all_ranks_are_here()) leave(line, exit_bad_input);
    throw InputError(line);
  }
  const bool not_a_number = ierr == PETSC_ERR_ARG_OUTOFRANGE && text.rfind("Input string", 0) == 0;
  const bool not_in_list = ierr == PETSC_ERR_USER && text.rfind("Unknown option", 0) == 0;
  if (ierr == PETSC_ERR_ARG_UNKNOWN_TYPE || ierr == PETSC_ERR_USER_INPUT ||
      ierr == PETSC_ERR_MISSING_FACTOR || not_a_number || not_in_list)
    throw InputError("solver option: " + text);
  const std::string option = solver_option_named(text);
  if (!option.empty()) throw OptionFailed(option + ": PETSc cannot take it: " + text);
  throw std::runtime_error(text + " (code " + std::to_string(ierr) + ", " + where.file_name() +
                           ":" + std::to_string(where.line()) + ")");
}

Mpi::Mpi(int& argc, char**& argv) {
  std::set_terminate(report_uncaught);
  prepare_one_process();
  report_crashes();
  MPI_Init(&argc, &argv);
  if (size(MPI_COMM_WORLD) > 1) ask_for_short_turns();
  report_crashes();  // MPI_Init has installed handlers of its own
  report_mpi_errors();
}

void give_up_on_mpi() { gave_up() = true; }

Mpi::~Mpi() {
  if (gave_up()) end_at_once(exit_failed);
  forget_mpi();
  MPI_Finalize();
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

/// Puts PETSc's options into PETSc's table. Call before PetscInitialize, which acts on some of
/// them.
/// \return the options in the table
/// \throws InputError for more than 400 options or a refused value
GivenOptions put_petsc_options(const UserOptions& user) {
  constexpr std::size_t most = 400;  // PETSc 3.18 holds at most 512
  GivenOptions put;
  std::string problem;
  for (const auto& [name, given] : user.merged()) {
    if (!is_petsc_option(name)) continue;
    if (given.source == Source::environment && !is_environment_option(name)) continue;
    put[name] = given;
    if (put.size() > most)
      throw InputError(name + ": more than " + std::to_string(most) + " options of PETSc's");
    check(PetscOptionsSetValue(nullptr, ("-" + name).c_str(),
                               given.value.empty() ? nullptr : given.value.c_str()));
  }
  for (const auto& [name, given] : put) {
    if (problem.empty()) problem = solver_option_problem(name, given.value);
    if (problem.empty()) problem = petsc_file_problem(name, given.value, put);
  }
  throw_verdict(problem, MPI_COMM_WORLD);
  note_petsc_files(put);
  check(PetscOptionsSetValue(nullptr, "-skip_petscrc", nullptr));
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

Session::Session(const char* program, const UserOptions& user) : program_(program) {
  const GivenOptions options = put_petsc_options(user);
  const bool by_petsc = wants_petsc_handlers(options);
  const bool by_system = options.contains("no_signal_handler");
  set_solver_options(options);
  const Without variable("PETSC_OPTIONS"), yaml("PETSC_OPTIONS_YAML");
  words_[0] = program_.data();
  word_ = words_.data();
  int count = 1;
  if (by_petsc || by_system) leave_crashes_to_the_system();
  // Before PetscInitialize, which reads options and whose own handler prints a page. A handler that
  // -on_error_... names is put on top of this one.
  check(PetscPushErrorHandler(remember_error, nullptr));
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

}  // namespace floe
