#include "output/gather.h"

#include <algorithm>
#include <numeric>

#include "floe/base/petsc.h"

namespace floe {
namespace {

std::vector<int> offsets_of(const std::vector<int>& counts) {
  std::vector<int> offsets(counts.size(), 0);
  for (std::size_t r = 1; r < counts.size(); ++r) offsets[r] = offsets[r - 1] + counts[r - 1];
  return offsets;
}

}  // namespace

Gather::Gather(MPI_Comm comm, std::span<const std::int32_t> global, std::int64_t total)
    : comm_(comm), total_(total) {
  const bool root = rank(comm) == 0;
  in_place_ = size(comm) == 1 && std::is_sorted(global.begin(), global.end());
  if (in_place_) return;
  const int mine = static_cast<int>(global.size());
  counts_.resize(root ? static_cast<std::size_t>(size(comm)) : 0);
  MPI_Gather(&mine, 1, MPI_INT, counts_.data(), 1, MPI_INT, 0, comm);
  if (root)
    global_.resize(static_cast<std::size_t>(std::accumulate(counts_.begin(), counts_.end(), 0)));
  MPI_Gatherv(global.data(), mine, MPI_INT32_T, global_.data(), counts_.data(),
              offsets_of(counts_).data(), MPI_INT32_T, 0, comm);
}

void Gather::collect(const void* rows, std::size_t count, std::size_t bytes, void* all) const {
  MPI_Datatype row = MPI_DATATYPE_NULL;
  MPI_Type_contiguous(static_cast<int>(bytes), MPI_BYTE, &row);
  MPI_Type_commit(&row);
  MPI_Gatherv(rows, static_cast<int>(count), row, all, counts_.data(), offsets_of(counts_).data(),
              row, 0, comm_);
  MPI_Type_free(&row);
}

}  // namespace floe
