// The stable step against what stepping shows: bisection on dt for growth of a small random
// perturbation (model.md, "Explicit dynamics": Stable step).
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "forces/mooring_line.h"
#include "stability/stable_step.h"
#include "support/blocks.h"
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

/// Stands for contacts that may come.
class Hidden final : public Force<Spatial>, public LimitsStep<Spatial> {
 public:
  explicit Hidden(double stiffness) : stiffness_(stiffness) {}
  std::string_view name() const override { return "hidden"; }
  Roles<Spatial> roles() override { return {.step = this}; }
  void add(const State<Spatial>&, Wrenches<Spatial>&) override {}
  void report(const State<Spatial>&, std::span<const double>, Columns&) const override {}
  double stiffness_bound(std::int32_t) const override { return 0; }
  Rates hidden_stiffness() const override { return {.stiffness = stiffness_}; }

 private:
  double stiffness_;  // [1/s^2]
};

/// A structure between two lines of 1e5 N/m, which moves along them only; perhaps with light blocks
/// that feel nothing.
struct Moored {
  double at = 0;       ///< [m]
  double tension = 0;  ///< of the lines [N]
  double damping = 0;  ///< of each line [N s/m]
  double hidden = 0;   ///< [1/s^2]
  int blocks = 0;
  double speed = 0;  ///< [m/s]

  static constexpr double stiffness = 1e5, reach = 290;  // [N/m, m]

  StableStep step() const {
    Lattice lattice;
    append_block(lattice, {4, 4, 2}, {at, 0, 0});
    lattice.sets["box"] = {0};
    for (int k = 0; k < blocks; ++k) append_block(lattice, {0.1, 0.2, 0.1}, {at, 10.0 + k, 0});
    Boundary guide;
    guide.name = guide.set = "box";
    guide.fixed = {false, true, true, true, true, true};
    Model<Spatial> model(lattice, PETSC_COMM_SELF, {guide});
    std::vector<MooringLine> lines;
    for (const double side : {-1.0, 1.0}) {
      const double slack = reach - tension / stiffness;
      lines.push_back({.name = "line",
                       .body = 0,
                       .fairlead = {at + 2 * side, 0, 0},
                       .anchor = {at + (2 + reach) * side, 0, 0},
                       .curve = TensionCurve({{slack, 0}, {slack + 1, stiffness}}),
                       .damping = damping});
    }
    model.add_force(make_mooring_lines(model.part(), std::move(lines)));
    if (hidden > 0) model.add_force(std::make_unique<Hidden>(hidden));
    State<Spatial> state(static_cast<std::size_t>(model.part().local));
    state.record(0)[Spatial::velocity] = speed;
    return stable_step(model, state);
  }
  /// From dt^2 (h + 2 k/m) + 2 dt (2 c/m) = 4.
  double expected() const {
    const double mass = 920 * 4 * 4 * 2, k = hidden + 2 * stiffness / mass, c = 2 * damping / mass;
    return (std::sqrt(c * c + 4 * k) - c) / k;
  }
};

/// A model of one mode is where the search arrives at once; what is left then is the rounding of
/// differences of large forces far from the origin, which is no rate.
TEST(StableStep, RoundingIsNoRate) {
  double worst = 0;
  int searches = 0;
  for (const double at : {0.0, 20.0, 2e4, 1e5})
    for (const double tension : {1e5, 1e7})
      for (const double damping : {0.0, 1e4, 1e5})
        for (const double hidden : {0.0, 3e4})
          for (const int blocks : {0, 1, 20})
            for (const double speed : {0.0, 1.1e-6, 1e-5, 1e-3}) {
              const Moored moored{at, tension, damping, hidden, blocks, speed};
              const StableStep found = moored.step();
              ++searches;
              worst = std::max(worst, std::abs(found.dt / moored.expected() - 1));
              ASSERT_NEAR(found.dt / moored.expected(), 1, 1e-3)
                  << "at " << at << " m, " << tension << " N, " << damping << " N s/m, hidden "
                  << hidden << ", " << blocks << " blocks, " << speed << " m/s: " << found.dt
                  << " s after " << found.evaluations << " evaluations";
            }
  std::printf("%d searches, largest error %.2g\n", searches, worst);
}

}  // namespace
}  // namespace floe::test
