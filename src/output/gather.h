/// \file
/// Collects rows of per-body or per-beam values from all ranks, in global order on rank 0.
#pragma once

#include <mpi.h>

#include <cstdint>
#include <span>
#include <vector>

#include "floe/base/item.h"

namespace floe {

/// Collects rows from all ranks on rank 0.
class Gather {
 public:
  Gather() = default;
  /// Collective.
  /// \param global  global index of each of this rank's rows
  /// \param total  number of rows over all ranks
  Gather(MPI_Comm comm, std::span<const std::int32_t> global, std::int64_t total);

  /// Returns all rows on rank 0, an empty vector elsewhere. Collective.
  /// \param rows  this rank's rows, of numbers or of arrays of numbers
  template <class Row>
  std::vector<Row> operator()(std::vector<Row> rows) const {
    if (in_place_) return rows;
    std::vector<Row> arrived(global_.size());
    collect(rows.data(), rows.size(), sizeof(Row), arrived.data());
    rows = {};
    std::vector<Row> ordered(arrived.empty() ? 0 : static_cast<std::size_t>(total_));
    for (std::size_t k = 0; k < arrived.size(); ++k) item(ordered, global_[k]) = arrived[k];
    return ordered;
  }

 private:
  void collect(const void* rows, std::size_t count, std::size_t bytes, void* all) const;

  MPI_Comm comm_ = MPI_COMM_NULL;
  std::int64_t total_ = 0;
  std::vector<int> counts_;
  std::vector<std::int32_t> global_;  ///< rank 0: global indices of all rows, rank after rank
  bool in_place_ = false;             ///< a single rank has all rows, in order
};

}  // namespace floe
