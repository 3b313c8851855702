/// \file
/// The lifetimes of MPI and PETSc, and the end of a process.
#pragma once

#include <mpi.h>

#include <array>
#include <functional>
#include <string>

#include "floe/options/given.h"

namespace floe {

/// A function that a rank calls last, with the printed line, when it ends on an uncaught error,
/// while this object lives. The function must neither fail nor wait for other ranks.
class LastWords {
 public:
  /// Called in the handler of a crash, where it may only make system calls (signal-safety(7)).
  /// Returns whether it has done all that there is to do; else `words` is called, which may hang.
  using InCrash = std::function<bool(const char*)>;
  explicit LastWords(std::function<void(const std::string&)> words, InCrash in_crash = {});
  ~LastWords();
  LastWords(const LastWords&) = delete;
  LastWords& operator=(const LastWords&) = delete;
};

/// Holds MPI from construction to destruction, and installs the terminate handler (print, last
/// words, MPI_Abort).
class Mpi {
 public:
  /// A process that another program rules, for example an interpreter.
  struct Guest {};

  Mpi(int& argc, char**& argv);
  /// Initialises MPI only if nobody has, and finalises it only then; installs the terminate
  /// handler, but no handlers of crashes. Floe's messages get a communicator of their own.
  explicit Mpi(Guest);
  ~Mpi();
  Mpi(const Mpi&) = delete;
  Mpi& operator=(const Mpi&) = delete;

 private:
  bool is_ours_ = true;                ///< whether MPI was initialised here
  MPI_Comm messages_ = MPI_COMM_NULL;  ///< of a guest
};

/// Holds PETSc from construction to destruction, with the options of PETSc's families among `user`.
/// PETSc reads no other options: neither petscrc files nor PETSC_OPTIONS (see read_environment).
class Session {
 public:
  /// \param program  name of the program, argv[0]
  /// \param handles_crashes  whether signals of a crash end the process with one line
  explicit Session(const char* program, const UserOptions& user = {}, bool handles_crashes = true);
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

}  // namespace floe
