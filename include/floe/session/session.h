/// \file
/// The lifetimes of MPI and PETSc, and the end of a process.
#pragma once

#include <array>
#include <functional>
#include <string>

#include "floe/options/given.h"

namespace floe {

/// Sets the function that a rank calls last, with the printed line, when it ends on an uncaught
/// error. The function must neither fail nor wait for other ranks. An empty function removes it.
void set_last_words(std::function<void(const std::string&)> last_words);

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

}  // namespace floe
