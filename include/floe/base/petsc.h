/// \file
/// The layer between floe and PETSc: a checked call, an owning handle, and the lifetimes of MPI and
/// PETSc.
#pragma once

#include <petsc.h>

#include <array>
#include <functional>
#include <source_location>
#include <stdexcept>
#include <string>
#include <utility>

#include "floe/options/given.h"

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

/// Throws after a failed PETSc or MPI call: InputError if the user asked for something that PETSc
/// lacks, otherwise std::runtime_error. Nothing catches the latter: the terminate handler prints it
/// and aborts all ranks, because unwinding on one rank would run collective destructors and hang.
[[noreturn]] void fail(int ierr, const std::source_location& where);

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

/// Sets the function that a rank calls last, with the printed line, when it ends on an uncaught
/// error. The function must neither fail nor wait for other ranks. An empty function removes it.
void set_last_words(std::function<void(const std::string&)> last_words);

/// Marks MPI as unable to finalise, because a library that MPI_Finalize calls has failed. ~Mpi then
/// ends the process with exit code 1.
void give_up_on_mpi();

/// Holds MPI from construction to destruction, and installs the terminate handler (print, last
/// words, MPI_Abort).
class Mpi {
 public:
  Mpi(int& argc, char**& argv);
  ~Mpi();
  Mpi(const Mpi&) = delete;
  Mpi& operator=(const Mpi&) = delete;
};

/// Holds PETSc from construction to destruction, with the options of PETSc's families among `user`.
/// PETSc reads no other options: neither petscrc files nor PETSC_OPTIONS (see read_environment).
/// \param program  name of the program, argv[0]
class Session {
 public:
  explicit Session(const char* program, const UserOptions& user = {});
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

 private:
  // PETSc keeps pointers to both.
  std::string program_;
  std::array<char*, 2> words_{};
  char** word_ = nullptr;
};

/// Removes the files that options of PETSc have made in a run that is refused (logs, files of
/// viewers), unless they were there before. Call after the end of the session, when PETSc has
/// closed them.
void drop_petsc_files() noexcept;

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
