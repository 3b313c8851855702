/// \file
/// The layer between floe and PETSc: errors, a checked call, and an owning handle.
#pragma once

#include <petsc.h>

#include <functional>
#include <new>
#include <source_location>
#include <stdexcept>
#include <string>
#include <utility>

namespace floe {

/// An exception that ends a run with one line and an exit code. All ranks raise it alike, before
/// any collective call that some rank would miss. main catches no other exception.
class Verdict : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// An error that the user can correct: a scene, an option, a file (exit code 2). The text is one
/// line that names the key, the value and the allowed values.
class InputError : public Verdict {
 public:
  using Verdict::Verdict;
};

/// The run cannot continue (exit code 1).
class RunFailed : public Verdict {
 public:
  using Verdict::Verdict;
};

/// A result file cannot be written (a full disk, no permission). One rank alone may raise it;
/// on_root() turns it into a RunFailed.
class FileError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// PETSc, or a solver behind PETSc, could not allocate memory.
class OutOfMemory : public std::bad_alloc {};

/// Throws InputError with rank 0's verdict on all ranks, unless the verdict is empty: for checks
/// that one rank makes and whose result all ranks must share. Collective; works before
/// PetscInitialize too.
void throw_verdict(std::string verdict, MPI_Comm comm);

/// Throws after a failed PETSc or MPI call: OutOfMemory, what the handler of set_failure_handler()
/// throws, otherwise std::runtime_error. Nothing catches the latter: the terminate handler prints
/// it and aborts all ranks, because unwinding on one rank would run collective destructors and
/// hang.
[[noreturn]] void fail(int ierr, const std::source_location& where);

/// Throws for errors whose cause it knows, given PETSc's code and its message in one line.
using FailureHandler = void (*)(int ierr, const std::string& petsc_says);
/// Sets the function that fail() calls first.
void set_failure_handler(FailureHandler handler);

/// Makes PETSc keep the message of an error for fail(); PETSc's default handler would print a page.
/// Call before PetscInitialize.
void keep_petsc_messages();

/// Marks MPI as unable to finalise, because a library that MPI_Finalize calls has failed. ~Mpi then
/// ends the process with exit code 1.
void give_up_on_mpi();
/// Whether MPI was given up.
bool mpi_is_given_up();

inline void check(int ierr, const std::source_location& where = std::source_location::current()) {
  if (ierr != 0) [[unlikely]]
    fail(ierr, where);
}

namespace detail {
inline PetscErrorCode destroy(Vec* v) { return VecDestroy(v); }
inline PetscErrorCode destroy(Mat* m) { return MatDestroy(m); }
inline PetscErrorCode destroy(KSP* k) { return KSPDestroy(k); }
inline PetscErrorCode destroy(SNES* s) { return SNESDestroy(s); }
inline PetscErrorCode destroy(TS* t) { return TSDestroy(t); }
inline PetscErrorCode destroy(IS* i) { return ISDestroy(i); }
inline PetscErrorCode destroy(PetscSF* s) { return PetscSFDestroy(s); }
inline PetscErrorCode destroy(MatNullSpace* n) { return MatNullSpaceDestroy(n); }
inline PetscErrorCode destroy(PetscViewer* v) { return PetscViewerDestroy(v); }
}  // namespace detail

/// Owner of one PETSc object; move-only. The result of the destruction is not checked. The
/// destruction is collective, as in PETSc.
template <class T>
class Handle {
 public:
  Handle() = default;
  explicit Handle(T object) : object_(object) {}
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  Handle(Handle&& other) noexcept : object_(std::exchange(other.object_, nullptr)) {}
  Handle& operator=(Handle&& other) noexcept {
    std::swap(object_, other.object_);
    return *this;
  }
  ~Handle() {
    if (object_) (void)detail::destroy(&object_);
  }

  /// Returns the object; the handle keeps the ownership.
  operator T() const { return object_; }  // NOLINT: PETSc calls take the bare object
  T get() const { return object_; }
  /// Returns the address that a PETSc Create call fills. Destroys the object held so far.
  T* put() {
    if (object_) (void)detail::destroy(&object_);
    object_ = nullptr;
    return &object_;
  }

 private:
  T object_ = nullptr;
};

/// Return the rank of this process and the number of ranks.
inline int rank(MPI_Comm comm = PETSC_COMM_WORLD) {
  int r = 0;
  MPI_Comm_rank(comm, &r);
  return r;
}
inline int size(MPI_Comm comm = PETSC_COMM_WORLD) {
  int n = 1;
  MPI_Comm_size(comm, &n);
  return n;
}

}  // namespace floe
