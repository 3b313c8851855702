/// \file
/// The distribution of the work of one sweep over ranks: contiguous blocks of cells or edges, with
/// whole results on every rank.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "floe/base/petsc.h"

namespace floe::mesh {

/// The rank's place among the ranks that mesh a plan together.
struct Share {
  MPI_Comm comm = MPI_COMM_NULL;  ///< unused with one rank
  int rank = 0, size = 1;

  Share() = default;
  explicit Share(MPI_Comm c) : comm(c), rank(floe::rank(c)), size(floe::size(c)) {}

  std::int32_t begin(std::int32_t n, int r) const {
    return static_cast<std::int32_t>(std::int64_t{n} * r / size);
  }
  /// Return the begin and end of this rank's block of 0 ... n-1.
  std::int32_t begin(std::int32_t n) const { return begin(n, rank); }
  std::int32_t end(std::int32_t n) const { return begin(n, rank + 1); }

  /// Completes `whole` on every rank, after every rank has filled its own block. Collective.
  template <class T>
  void gather(std::vector<T>& whole) const {
    if (size == 1) return;
    const auto n = static_cast<std::int32_t>(whole.size());
    std::vector<int> count(size), offset(size);
    for (int r = 0; r < size; ++r) {
      offset[r] = begin(n, r);
      count[r] = begin(n, r + 1) - offset[r];
    }
    exchange(MPI_IN_PLACE, 0, whole.data(), count, offset, sizeof(T));
  }

  /// Concatenates the lists of all ranks, in order of the ranks. Collective.
  template <class T>
  void concatenate(std::vector<T>& list) const {
    if (size == 1) return;
    std::vector<int> count(size), offset(size);
    const int mine = static_cast<int>(list.size());
    check(MPI_Allgather(&mine, 1, MPI_INT, count.data(), 1, MPI_INT, comm));
    for (int r = 1; r < size; ++r) offset[r] = offset[r - 1] + count[r - 1];
    std::vector<T> all(static_cast<std::size_t>(offset.back()) + count.back());
    exchange(list.data(), mine, all.data(), count, offset, sizeof(T));
    list = std::move(all);
  }

 private:
  /// Calls MPI_Allgatherv for records of `bytes` bytes.
  void exchange(const void* mine, int n, void* all, const std::vector<int>& count,
                const std::vector<int>& offset, std::size_t bytes) const {
    MPI_Datatype record;
    check(MPI_Type_contiguous(static_cast<int>(bytes), MPI_BYTE, &record));
    check(MPI_Type_commit(&record));
    check(MPI_Allgatherv(mine, n, record, all, count.data(), offset.data(), record, comm));
    check(MPI_Type_free(&record));
  }
};

}  // namespace floe::mesh
