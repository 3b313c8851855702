/// \file
/// What floe needs around PETSc: a checked call, an owning handle, and the life of a session.
#pragma once

#include <petsc.h>

#include <array>
#include <functional>
#include <source_location>
#include <stdexcept>
#include <string>
#include <utility>

#include "floe/base/given.h"

namespace floe {

/// What ends a run with one line and an exit code. Always raised alike on all ranks, before any
/// collective call that some rank would miss. Nothing else is caught by main.
class Verdict : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// What the user can put right: a scene, an option, a file (exit code 2). The text is one line that
/// names the key, the value and what is allowed.
class InputError : public Verdict {
 public:
  using Verdict::Verdict;
};

/// A run cannot go on (exit code 1).
class RunFailed : public Verdict {
 public:
  using Verdict::Verdict;
};

/// A file of the results cannot be written (a full disk, no permission). May be raised on one rank
/// alone; on_root() makes a RunFailed of it.
class FileError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Throws if a PETSc (or MPI) call failed: InputError if the user asked for what PETSc does not
/// have, otherwise std::runtime_error, which nobody catches: the terminate handler prints it and
/// aborts all ranks (unwinding on one rank would run collective destructors and hang).
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

/// Owner of one PETSc object; move-only. Destruction is not checked (and is collective, as PETSc's
/// is).
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

  /// The object, borrowed.
  operator T() const { return object_; }  // NOLINT: PETSc calls take the bare object
  T get() const { return object_; }
  /// Where a PETSc Create call puts a new object; what was held is given up first.
  T* put() {
    if (object_) (void)detail::destroy(&object_);
    object_ = nullptr;
    return &object_;
  }

 private:
  T object_ = nullptr;
};

/// What a rank does last when it ends on an error that nobody catches, beside printing it: told
/// the line that was printed. Must not fail, nor wait for other ranks. Empty: nothing.
void set_last_words(std::function<void(const std::string&)> last_words);

/// MPI cannot end in order any more: a library that it would call has failed. The process then ends
/// where Mpi would, with exit code 1.
void give_up_on_mpi();

/// MPI from construction to destruction; installs the terminate handler (print, last words,
/// MPI_Abort).
class Mpi {
 public:
  Mpi(int& argc, char**& argv);
  ~Mpi();
  Mpi(const Mpi&) = delete;
  Mpi& operator=(const Mpi&) = delete;
};

/// PETSc from construction to destruction, with the options of PETSc's families among `user`; it
/// reads no other: neither petscrc files nor PETSC_OPTIONS (read_environment does).
/// \param program  the program's name, argv[0]
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

/// Takes away the files that options of PETSc's have made in a run that is refused (a log, a
/// viewer's): those that were not there before. After the session's end, when PETSc has closed
/// them.
void drop_petsc_files() noexcept;

/// This process's rank and the number of ranks.
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
