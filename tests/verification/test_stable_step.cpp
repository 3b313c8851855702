// The stable step against what stepping shows: bisection on dt for growth of a small random
// perturbation (model.md, "Explicit dynamics": Stable step).
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "stability/stable_step.h"
#include "support/dynamics.h"
#include "support/random.h"
#include "support/record.h"
#include "support/stepped_sheets.h"

namespace floe::test {
namespace {

constexpr const char* section_name = "Explicit dynamics";

/// Whether velocities of 1e-9 m/s grow a thousandfold in 4000 steps.
bool grows(const Scene& scene, const Lattice& lattice, double dt) {
  Dynamics run(scene, lattice);
  run.set_step(dt);
  Random random(7);
  State<Spatial>& state = run.state();
  for (std::size_t b = 0; b < static_cast<std::size_t>(lattice.bodies.size()); ++b) {
    const Vec3<double> v = random.vector(1e-9);
    double* r = state.record(b) + Spatial::velocity;
    r[0] = v.x, r[1] = v.y, r[2] = v.z;
  }
  run.evaluate();
  constexpr int steps = 4000;
  for (int n = 0; n < steps; ++n) {
    if (!(run.step() < 1e-12)) return true;
  }
  return false;
}

/// Largest dt that does not make a perturbation grow, to 0.2 %.
double measured_limit(const Scene& scene, const Lattice& lattice, double guess) {
  double low = 0.9 * guess, high = 1.1 * guess;
  while (grows(scene, lattice, low)) low *= 0.8;
  while (!grows(scene, lattice, high)) high *= 1.25;
  while (high - low > 0.002 * low) {
    const double middle = 0.5 * (low + high);
    (grows(scene, lattice, middle) ? high : low) = middle;
  }
  return 0.5 * (low + high);
}

/// Bodies of a sheet on which the limiting mode is one of many thousands.
Lattice large_sheet() { return mesh_of(tension_scene(40, 0.5, 1, 2)); }

TEST(StableStep, IsWhereAPerturbationBeginsToGrow) {
  struct Sheet {
    const char* name;
    Lattice lattice;
    double l;
  };
  std::vector<Sheet> sheets{{"random sheet", random_sheet(), 1.1},
                            {"regular sheet", regular_sheet(), 1.2},
                            {"sliver facet, mass ratio 1e4", extreme_sheet(), 1.1}};
  if (full_form()) sheets.push_back({"large random sheet", large_sheet(), 1});
  for (const Sheet& sheet : sheets) {
    struct Damping {
      double ratio;
      DampingModes modes;
      const char* name;
    };
    for (const Damping& damping : {Damping{0, DampingModes::all, "undamped"},
                                   Damping{0.1, DampingModes::axial, "zeta = 0.1 axial"},
                                   Damping{0.1, DampingModes::all, "zeta = 0.1 all"},
                                   Damping{1, DampingModes::axial, "zeta = 1 axial"},
                                   Damping{1, DampingModes::all, "zeta = 1 all"}}) {
      Scene scene;
      scene.forces.beam = true;
      scene.beam.damping_ratio = damping.ratio;
      scene.beam.damping_modes = damping.modes;
      Dynamics at_rest(scene, sheet.lattice);
      const StableStep stable = stable_step(at_rest.model(), at_rest.state());
      const double measured = measured_limit(scene, sheet.lattice, stable.dt);
      char note[160];
      std::snprintf(note, sizeof note,
                    "%d bodies; stable_dt/l = %.3g s/m, %d evaluations of forces",
                    sheet.lattice.bodies.size(), stable.dt / sheet.l, stable.evaluations);
      verify({.section = section_name,
              .quantity = std::string("stable step over the measured limit, ") + sheet.name + ", " +
                          damping.name,
              .value = stable.dt / measured,
              .reference = 1.0,
              .tolerance = 0.03,
              .note = note});
    }
  }
}

}  // namespace
}  // namespace floe::test
