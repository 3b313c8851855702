#include "scene_model/size_check.h"

#include "floe/base/petsc.h"
#include "floe/files/log.h"
#include "floe/lattice/state.h"
#include "run/expected_cost.h"
#include "scene_model/amounts.h"

namespace floe {

using amounts::bytes, amounts::count;

void check_size(const Scene& scene, double free, int ranks) {
  const auto bodies = static_cast<double>(number_of_cells(scene.sheet));
  double needed = lattice_bytes(bodies, ranks);
  if (scene.integrator != Integrator::explicit_) {
    const bool flat = scene.integrator == Integrator::quasistatic && !scene.forces.gravity &&
                      !scene.forces.fracture && scene.planar != Planarity::never;
    const double unknowns = bodies * (flat ? Planar::unknowns : Spatial::unknowns);
    needed += factorisation_cost(unknowns, ranks).bytes;
  }
  constexpr double honest = 3;  // factor to which estimates are good
  const double most = scene.limit.memory > 0 ? 1e9 * scene.limit.memory : honest * free;
  const std::string what =
      "sheet: about " + count(bodies) + " bodies would take about " + bytes(needed) + " of memory";
  if (needed > most)
    throw InputError(what + ", " +
                     (scene.limit.memory > 0 ? "at most " + bytes(most) + " are taken"
                                             : bytes(free) + " are free") +
                     " (limit: memory)");
  if (rank() == 0 && needed > free)
    warn(what + " (to a factor of 3), " + bytes(free) + " are free");
}

}  // namespace floe
