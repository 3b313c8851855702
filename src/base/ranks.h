/// \file
/// Numbers on which ranks decide alike.
#pragma once

#include <mpi.h>

#include <cmath>
#include <limits>
#include <span>

namespace floe {

/// The largest of each number over all ranks. What is not a number counts as infinity: MPI may lose
/// it or give each rank another answer, and ranks that decide differently wait for each other.
/// Collective.
inline void largest_over_ranks(std::span<double> values, MPI_Comm comm) {
  for (double& value : values) {
    if (std::isnan(value)) value = std::numeric_limits<double>::infinity();
  }
  MPI_Allreduce(MPI_IN_PLACE, values.data(), static_cast<int>(values.size()), MPI_DOUBLE, MPI_MAX,
                comm);
}
inline double largest_over_ranks(double mine, MPI_Comm comm) {
  largest_over_ranks(std::span(&mine, 1), comm);
  return mine;
}

}  // namespace floe
