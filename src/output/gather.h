/// \file
/// Rows of per-body or per-beam values from all ranks, in global order on rank 0.
#pragma once

#include <mpi.h>

#include <cstdint>
#include <span>
#include <vector>

namespace floe {

class Gather {
 public:
  /// \param global  global index of each of this rank's rows   \param total  rows over all ranks
  Gather(MPI_Comm comm, std::span<const std::int32_t> global, std::int64_t total);

  /// total x width values on rank 0, empty elsewhere. Collective. \param rows  this rank's,
  /// row-major
  std::vector<double> operator()(std::span<const double> rows, int width) const;

 private:
  MPI_Comm comm_;
  std::int64_t total_;
  std::vector<int> counts_;
  std::vector<std::int32_t> global_;  ///< rank 0: of all rows, rank after rank
};

}  // namespace floe
