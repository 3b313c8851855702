/// \file
/// Work of rank 0 whose failure all ranks share.
#pragma once

#include <string>

#include "floe/base/petsc.h"

namespace floe {

/// How a rank's work ended.
struct Outcome {
  enum Kind : int { good, bad_input, failed } kind = good;
  std::string why;
};

/// Raises rank 0's outcome alike on all ranks: InputError or RunFailed. Collective.
void share_outcome(Outcome outcome, MPI_Comm comm);

/// What work came to that may raise InputError or FileError.
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

/// Lets rank 0 do such work; what it raises is raised on all ranks. Collective.
template <class Work>
void on_root(MPI_Comm comm, Work&& work) {
  share_outcome(rank(comm) == 0 ? outcome_of(work) : Outcome{}, comm);
}

}  // namespace floe
