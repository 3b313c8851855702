// The energy ledger of leapfrog closes with the step (model.md, "Explicit dynamics": Energy
// ledger).
#include <array>
#include <cmath>
#include <string>

#include "support/explicit_run.h"
#include "support/record.h"
#include "support/tension.h"

namespace floe::test {
namespace {

constexpr const char* section_name = "Explicit dynamics";

TEST(EnergyBalance, ClosesWithTheStep) {
  const Lattice lattice = mesh_of(tension_scene(10, 0.5, 1.5, 3));
  Scene pull = tension_scene(10, 0.5, 1.5, 3);
  pull.boundaries[1].displacement.reset();
  pull.boundaries[1].velocity = Point3{0.1, 0, 0};
  pull.boundaries[1].ramp.seconds = 0.01;
  pull.beam.damping_ratio = 1;
  pull.time.end = 0.02;
  Scene load = pull;
  load.boundaries.pop_back();
  load.beam.damping_ratio = 0.1;
  Load edge;
  edge.name = "edge", edge.set = "right", edge.force = {1e6, 0, 2e3}, edge.moment = {0, 1e3, 0};
  edge.ramp.seconds = 0.01;
  load.loads = {edge};
  Scene undamped = load;
  undamped.beam.damping_ratio = 0;
  struct Case {
    const char* name;
    const Scene& scene;
  };
  for (const Case& c : {Case{"damped pull by a boundary", pull}, Case{"damped ramped load", load},
                        Case{"undamped ramped load", undamped}}) {
    const double stable = stable_of(c.scene, lattice);
    std::array<double, 3> errors{};
    double moved = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      auto columns =
          run_scene(c.scene, lattice, 0.4 * stable / static_cast<double>(1 << 2 * k)).columns;
      errors[k] = std::abs(columns["energy_balance_error"]);
      moved = std::abs(columns["energy_boundary"]) + std::abs(columns["energy_external"]);
      report({.section = section_name,
              .quantity = text("energy balance, %s: error over the work, dt %g of stable_dt",
                               c.name, 0.4 / (1 << 2 * k)),
              .value = errors[k] / moved});
    }
    verify(
        {.section = section_name,
         .quantity = text("energy balance, %s: error over the work, dt 0.1 of stable_dt", c.name),
         .value = errors[1] / moved,
         .reference = 0.0,
         .tolerance = 1e-3});
    verify({.section = section_name,
            .quantity = text("energy balance, %s: order of the error", c.name),
            .value = 0.5 * std::log2(errors[1] / errors[2]),
            .reference = 2.0,
            .tolerance = 0.3});
  }
}

}  // namespace
}  // namespace floe::test
