#include "floe/base/petsc.h"

#include <cctype>
#include <string_view>

#include "base/collectives.h"

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

FailureHandler& failure_handler() {
  static FailureHandler handler = nullptr;
  return handler;
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

void set_failure_handler(FailureHandler handler) { failure_handler() = handler; }

void fail(int ierr, const std::source_location& where) {
  const std::string text = take_last_message(ierr);
  if (is_out_of_memory(ierr, text)) throw OutOfMemory();
  if (failure_handler() != nullptr) failure_handler()(ierr, text);
  throw std::runtime_error(text + " (code " + std::to_string(ierr) + ", " + where.file_name() +
                           ":" + std::to_string(where.line()) + ")");
}

void keep_petsc_messages() { check(PetscPushErrorHandler(remember_error, nullptr)); }

void give_up_on_mpi() { gave_up() = true; }

bool mpi_is_given_up() { return gave_up(); }

void throw_verdict(std::string verdict, MPI_Comm comm) {
  broadcast(verdict, comm);
  if (!verdict.empty()) throw InputError(verdict);
}

}  // namespace floe
