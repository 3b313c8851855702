#include "implicit/implicit_ts_options.h"

#include <petscts.h>

#include <string>

#include "floe/base/petsc.h"
#include "implicit/liealpha.h"
#include "run/ts_options.h"

namespace floe {

void check_implicit_options() {
  const std::string type = ts_option("-ts_type").value_or(ts_liealpha);
  if (type == TSALPHA2)
    throw InputError(
        "ts_type: 'alpha2' cannot step this scene: it forgets its history when a step's rotations "
        "are taken over (integrator: implicit steps with liealpha, the same method at "
        "-ts_liealpha_radius 1)");
  if (type != ts_liealpha)
    throw InputError("ts_type: '" + type +
                     "' cannot step this scene: it does not know rotations "
                     "(integrator: implicit steps with liealpha)");
  refuse_ts_times("implicit");
}

}  // namespace floe
