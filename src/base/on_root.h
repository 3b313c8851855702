/// \file
/// Work of rank 0 whose failure is raised on all ranks.
#pragma once

#include <string>

#include "floe/base/petsc.h"

namespace floe {

/// The outcome of work on one rank.
struct Outcome {
  enum Kind : int { good, bad_input, failed } kind = good;
  std::string why;
};

/// Raises rank 0's outcome on all ranks: InputError or RunFailed, or nothing if it is good.
/// Collective.
void share_outcome(Outcome outcome, MPI_Comm comm);

/// Returns the outcome of work that may raise InputError or FileError.
template <class Work>
Outcome outcome_of(Work&& work) {
  try {
    work();
  } catch (const InputError& error) {
    return {Outcome::bad_input, error.what()};
  } catch (const FileError& error) {
    return {Outcome::failed, error.what()};
  }
  return {};
}

/// Runs `work` on rank 0 and raises its InputError, or its FileError as RunFailed, on all ranks.
/// Collective.
template <class Work>
void on_root(MPI_Comm comm, Work&& work) {
  share_outcome(rank(comm) == 0 ? outcome_of(work) : Outcome{}, comm);
}

}  // namespace floe
