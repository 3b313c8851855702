// Stable steps of PETSc's Runge-Kutta methods: their polynomials, and what stepping shows
// (model.md, "Explicit dynamics": Runge-Kutta).
#include <petscts.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <string>
#include <vector>

#include "stability/rk_stability.h"
#include "support/explicit_run.h"
#include "support/random.h"
#include "support/record.h"
#include "support/static_solution.h"
#include "support/stepped_sheets.h"

namespace floe::test {
namespace {

constexpr const char* section_name = "Runge-Kutta";

StabilityPolynomial polynomial_of(const char* type) {
  Handle<TS> ts;
  check(TSCreate(PETSC_COMM_SELF, ts.put()));
  check(TSSetType(ts, TSRK));
  check(TSRKSetType(ts, type));
  PetscInt stages = 0;
  const PetscReal *a = nullptr, *b = nullptr;
  check(TSRKGetTableau(ts, &stages, &a, &b, nullptr, nullptr, nullptr, nullptr, nullptr));
  const auto s = static_cast<std::size_t>(stages);
  return {std::span(a, s * s), std::span(b, s)};
}

TEST(StabilityPolynomial, IsTheExponentialToTheMethodsOrder) {
  struct Method {
    const char* type;
    std::size_t order;
  };
  for (const Method& m : {Method{"1fe", 1}, Method{"2a", 2}, Method{"2b", 2}, Method{"3", 3},
                          Method{"3bs", 3}, Method{"4", 4}, Method{"5f", 5}, Method{"5dp", 5},
                          Method{"5bs", 5}, Method{"6vr", 6}, Method{"7vr", 7}, Method{"8vr", 8}}) {
    const StabilityPolynomial r = polynomial_of(m.type);
    double factorial = 1;
    for (std::size_t k = 0; k <= m.order; ++k) {
      factorial *= k > 0 ? static_cast<double>(k) : 1.0;
      EXPECT_NEAR(r.coefficients()[k] * factorial, 1, 1e-12) << m.type << " " << k;
    }
    EXPECT_GT(std::abs(r.coefficients()[std::min(m.order + 1, r.coefficients().size() - 1)] *
                           factorial * static_cast<double>(m.order + 1) -
                       1),
              1e-3)
        << m.type;
  }
}

TEST(StabilityPolynomial, HasTheKnownIntervals) {
  struct Interval {
    const char* type;
    double imaginary, real;
  };
  // Of z^k/k! up to 3 and 4: sqrt(3), sqrt(8) and the real roots of |R| = 1 (Hairer & Wanner 1996,
  // table IV.2.1).
  for (const Interval& i : {Interval{"3", std::sqrt(3.0), 2.51274532661833},
                            Interval{"4", std::sqrt(8.0), 2.78529356340528}}) {
    const StabilityPolynomial r = polynomial_of(i.type);
    const double omega = 7;
    EXPECT_NEAR(r.largest_step(omega * omega, 0) * omega, i.imaginary, 1e-6) << i.type;
    EXPECT_NEAR(r.largest_step(0, omega) * omega, i.real, 1e-6) << i.type;
  }
  for (const char* type : {"1fe", "2a", "2b", "5f"})
    EXPECT_LT(polynomial_of(type).largest_step(1, 0), 0.2) << type;
  // Euler's: |1 + lambda dt| = 1 of a damped oscillation, dt = 2 zeta/omega.
  EXPECT_NEAR(polynomial_of("1fe").largest_step(4, 0.8), 0.2, 1e-6);
}

// What a run shows: velocities of 1e-9 m/s that reach 0.01 m/s in so many steps.
constexpr int steps = 1000;
const double seen = std::pow(1e7, 1.0 / steps) - 1;

bool grows(const char* type, Scene scene, Lattice lattice, double dt) {
  const PetscOption rk("-ts_type", "rk"), kind("-ts_rk_type", type);
  Random random(7);
  for (std::size_t b = 0; b < lattice.bodies.mass.size(); ++b) {
    lattice.bodies.velocity.push_back(random.vector(1e-9));
    lattice.bodies.angular_velocity.push_back({0, 0, 0});
  }
  scene.time.allow_unstable = true;
  scene.time.end = steps * dt;
  scene.limit.velocity = 1e-2;
  scene.limit.energy_error = 1e300;
  return !run_scene(scene, lattice, dt).result.done;
}

/// Largest dt that does not make a perturbation grow, to 0.3 %.
double measured_limit(const char* type, const Scene& scene, const Lattice& lattice, double guess) {
  double low = 0.98 * guess, high = 1.04 * guess;
  while (grows(type, scene, lattice, low)) low *= 0.9;
  while (!grows(type, scene, lattice, high)) high *= 1.1;
  while (high - low > 0.003 * low) {
    const double middle = 0.5 * (low + high);
    (grows(type, scene, lattice, middle) ? high : low) = middle;
  }
  return 0.5 * (low + high);
}

TEST(RkStability, StepsAreStableUpToWhereAPerturbationBeginsToGrow) {
  struct Sheet {
    const char* name;
    Lattice lattice;
  };
  const std::vector<Sheet> sheets{{"random sheet", random_sheet()},
                                  {"regular sheet", regular_sheet()},
                                  {"sliver facet, mass ratio 1e4", extreme_sheet()}};
  struct Damping {
    double ratio;
    DampingModes modes;
    const char* name;
  };
  struct Case {
    const Sheet& sheet;
    const char* type;
  };
  std::vector<Case> cases{{sheets[0], "4"}, {sheets[0], "5dp"}, {sheets[1], "4"}};
  if (full_form()) {
    cases.push_back({sheets[2], "4"});
    for (const char* type : {"2a", "3bs", "5f", "8vr"}) cases.push_back({sheets[0], type});
  }
  for (const auto& [sheet, type] : cases) {
    for (const Damping& damping : {Damping{0, DampingModes::all, "undamped"},
                                   Damping{0.1, DampingModes::axial, "zeta = 0.1 axial"},
                                   Damping{0.1, DampingModes::all, "zeta = 0.1 all"},
                                   Damping{1, DampingModes::axial, "zeta = 1 axial"},
                                   Damping{1, DampingModes::all, "zeta = 1 all"}}) {
      // In the short form only the first case has those between none and most.
      if (!full_form() && &type != &cases[0].type && damping.ratio == 0.1) continue;
      const Scene scene = beams_only(Shear::one_point, damping.ratio, damping.modes);
      Dynamics at_rest(scene, sheet.lattice);
      const StabilityPolynomial polynomial = polynomial_of(type);
      const StableStep stable = rk_stable_step(polynomial, at_rest.model(), at_rest.state(), seen);
      const double strict = rk_stable_step(polynomial, at_rest.model(), at_rest.state()).dt;
      const double measured = measured_limit(type, scene, sheet.lattice, stable.dt);
      EXPECT_LE(strict, stable.dt);
      // Where the imaginary axis decides, pairs of the range may lie between those of modes.
      const bool safe = std::string(type) != "4";
      verify({.section = section_name,
              .quantity = text("%s: stable step over the measured limit, %s, %s", type, sheet.name,
                               damping.name),
              .value = stable.dt / measured,
              .reference = safe ? 0.955 : 0.985,
              .tolerance = safe ? 0.05 : 0.02,
              .note = text("as far as %d steps show; used is %.3f of it, with no growth at all; %d "
                           "evaluations of forces",
                           steps, strict / stable.dt, stable.evaluations)});
    }
  }
}

}  // namespace
}  // namespace floe::test
