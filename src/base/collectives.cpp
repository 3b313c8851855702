#include "base/collectives.h"

#include <algorithm>

namespace floe {
namespace {

/// Broadcasts in pieces, because MPI counts in int.
template <class T>
void broadcast_pieces(T* values, std::int64_t count, MPI_Comm comm, int root) {
  constexpr std::int64_t piece = 1 << 28;
  for (std::int64_t at = 0; at < count; at += piece)
    MPI_Bcast(values + at, static_cast<int>(std::min(piece, count - at)), mpi_type<T>(), root,
              comm);
}

template <class Values>
void broadcast_all(Values& values, MPI_Comm comm, int root) {
  auto count = static_cast<std::int64_t>(values.size());
  broadcast(count, comm, root);
  values.resize(static_cast<std::size_t>(count));
  broadcast_pieces(values.data(), count, comm, root);
}

}  // namespace

void broadcast(std::string& text, MPI_Comm comm, int root) { broadcast_all(text, comm, root); }
void broadcast(std::vector<double>& values, MPI_Comm comm, int root) {
  broadcast_all(values, comm, root);
}

}  // namespace floe
