#include "base/on_root.h"

namespace floe {

void share(std::string& text, MPI_Comm comm) {
  auto length = static_cast<int>(text.size());
  MPI_Bcast(&length, 1, MPI_INT, 0, comm);
  text.resize(static_cast<std::size_t>(length));
  MPI_Bcast(text.data(), length, MPI_CHAR, 0, comm);
}

void share_outcome(Outcome outcome, MPI_Comm comm) {
  int kind = outcome.kind;
  MPI_Bcast(&kind, 1, MPI_INT, 0, comm);
  if (kind == Outcome::good) return;
  share(outcome.why, comm);
  if (kind == Outcome::bad_input) throw InputError(outcome.why);
  throw RunFailed(outcome.why);
}

}  // namespace floe
