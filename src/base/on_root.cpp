#include "base/on_root.h"

#include "base/collectives.h"

namespace floe {

void share_outcome(Outcome outcome, MPI_Comm comm) {
  int kind = outcome.kind;
  broadcast(kind, comm);
  if (kind == Outcome::good) return;
  broadcast(outcome.why, comm);
  if (kind == Outcome::bad_input) throw InputError(outcome.why);
  throw RunFailed(outcome.why);
}

}  // namespace floe
