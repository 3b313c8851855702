/// \file
/// Rows of all ranks, on all ranks.
#pragma once

#include <mpi.h>

#include <vector>

#include "floe/base/petsc.h"

namespace floe {

/// All ranks' values one after the other. Collective. \param counts  filled: each rank's number of
/// them, if wanted
template <class T>
std::vector<T> all_gathered(const std::vector<T>& mine, MPI_Datatype type, MPI_Comm comm,
                            std::vector<int>* counts = nullptr) {
  std::vector<int> each(static_cast<std::size_t>(size(comm))), offsets;
  const int count = static_cast<int>(mine.size());
  MPI_Allgather(&count, 1, MPI_INT, each.data(), 1, MPI_INT, comm);
  int sum = 0;
  for (const int n : each) {
    offsets.push_back(sum);
    sum += n;
  }
  std::vector<T> all(static_cast<std::size_t>(sum));
  MPI_Allgatherv(mine.data(), count, type, all.data(), each.data(), offsets.data(), type, comm);
  if (counts != nullptr) *counts = each;
  return all;
}

}  // namespace floe
