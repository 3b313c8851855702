#include "base/audit.h"

#include <petsc/private/petscimpl.h>  // PetscObjectStateGet

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "floe/base/petsc.h"

namespace floe {
namespace {

bool& switched_on() {
#ifdef FLOE_AUDIT
  static bool on = true;
#else
  static bool on = false;
#endif
  return on;
}

}  // namespace

bool auditing() { return switched_on(); }
void set_auditing(bool on) { switched_on() = on; }

void audit(MPI_Comm comm, const char* where, std::span<const PetscObject> objects,
           std::span<const double> numbers) {
  if (!auditing() || size(comm) == 1) return;
  std::vector<std::int64_t> mine;
  for (const PetscObject object : objects) {
    PetscObjectState state = -1;
    if (object != nullptr) check(PetscObjectStateGet(object, &state));
    mine.push_back(state);
  }
  for (const double number : numbers)  // one bit pattern for every NaN
    mine.push_back(std::bit_cast<std::int64_t>(
        std::isnan(number) ? std::numeric_limits<double>::quiet_NaN() : number));
  std::vector<std::int64_t> least(mine.size()), most(mine.size());
  const int count = static_cast<int>(mine.size());
  MPI_Allreduce(mine.data(), least.data(), count, MPI_INT64_T, MPI_MIN, comm);
  MPI_Allreduce(mine.data(), most.data(), count, MPI_INT64_T, MPI_MAX, comm);
  for (std::size_t k = 0; k < mine.size(); ++k) {
    if (least[k] == most[k]) continue;
    const bool object = k < objects.size();
    throw std::logic_error(
        std::string("audit: ") + where + ": " +
        (object ? "object " + std::to_string(k) + " was changed on some ranks"
                : "number " + std::to_string(k - objects.size()) + " differs between ranks"));
  }
}

}  // namespace floe
