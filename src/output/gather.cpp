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
  const int mine = static_cast<int>(global.size());
  counts_.resize(root ? static_cast<std::size_t>(size(comm)) : 0);
  MPI_Gather(&mine, 1, MPI_INT, counts_.data(), 1, MPI_INT, 0, comm);
  if (root)
    global_.resize(static_cast<std::size_t>(std::accumulate(counts_.begin(), counts_.end(), 0)));
  MPI_Gatherv(global.data(), mine, MPI_INT32_T, global_.data(), counts_.data(),
              offsets_of(counts_).data(), MPI_INT32_T, 0, comm);
}

std::vector<double> Gather::operator()(std::span<const double> rows, int width) const {
  MPI_Datatype row = MPI_DATATYPE_NULL;
  MPI_Type_contiguous(width, MPI_DOUBLE, &row);
  MPI_Type_commit(&row);
  std::vector<double> arrived(global_.size() * static_cast<std::size_t>(width));
  MPI_Gatherv(rows.data(), static_cast<int>(rows.size()) / width, row, arrived.data(),
              counts_.data(), offsets_of(counts_).data(), row, 0, comm_);
  MPI_Type_free(&row);
  if (rank(comm_) != 0) return {};
  std::vector<double> ordered(static_cast<std::size_t>(total_) * static_cast<std::size_t>(width));
  for (std::size_t k = 0; k < global_.size(); ++k) {
    const auto w = static_cast<std::ptrdiff_t>(width);
    std::copy_n(arrived.begin() + static_cast<std::ptrdiff_t>(k) * w, w,
                ordered.begin() + global_[k] * w);
  }
  return ordered;
}

}  // namespace floe
