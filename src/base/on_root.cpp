#include "floe/base/on_root.h"

#include <array>

namespace floe {

void share_outcome(Outcome outcome, MPI_Comm comm) {
  std::array<int, 2> head{outcome.kind, static_cast<int>(outcome.why.size())};
  MPI_Bcast(head.data(), 2, MPI_INT, 0, comm);
  if (head[0] == Outcome::good) return;
  outcome.why.resize(static_cast<std::size_t>(head[1]));
  MPI_Bcast(outcome.why.data(), head[1], MPI_CHAR, 0, comm);
  if (head[0] == Outcome::bad_input) throw InputError(outcome.why);
  throw RunFailed(outcome.why);
}

}  // namespace floe
