// Paths on which beams break and soften, against closed forms: a softening chain that snaps back, a
// bundle of fibres behind a spring; a notched sheet.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "support/paths.h"
#include "support/record.h"

namespace floe::test {
namespace {

constexpr double young = 4e9, strength = 6e5;

/// A bar between bodies along x.
struct Bar {
  std::int32_t i, j;
  double area, young;
};

/// Bodies at the places x, joined by bars as long as the distance of their bodies.
Lattice bars(const std::vector<Point3>& places, const std::vector<Bar>& all) {
  Lattice lattice;
  for (const Point3& x : places) {
    lattice.bodies.position.push_back(x);
    lattice.bodies.orientation.push_back({1, 0, 0, 0});
    lattice.bodies.mass.push_back(1);
    lattice.bodies.inertia.push_back({1, 1, 1});
  }
  Beams& b = lattice.beams;
  for (const Bar& bar : all) {
    const Point3 &from = places[static_cast<std::size_t>(bar.i)],
                 &to = places[static_cast<std::size_t>(bar.j)];
    const double side = std::sqrt(bar.area), inertia = bar.area * bar.area / 12;
    b.bodies.push_back({bar.i, bar.j});
    b.area.push_back(bar.area), b.width.push_back(side), b.height.push_back(side);
    b.inertia_y.push_back(inertia), b.inertia_z.push_back(inertia);
    b.torsion.push_back(0.1408 * bar.area * bar.area);
    b.length.push_back(std::hypot(to[0] - from[0], to[1] - from[1]));
    b.young.push_back(bar.young), b.shear_modulus.push_back(bar.young / 2);
    b.shear_factor.push_back(5.0 / 6), b.axis_y.push_back({0, 1, 0});
  }
  return lattice;
}

Scene breaking_scene(double energy) {
  Scene scene;
  scene.forces.beam = scene.forces.fracture = true;
  scene.fracture.tensile_strength = scene.fracture.shear_strength = strength;
  scene.fracture.energy = scene.fracture.energy_shear = energy;
  scene.fracture.dynamic = false;
  scene.fracture.propagation = Propagation::strength;  // rows of beams have no cracks
  return scene;
}

/// Holds all of the set `fixed`, pulls `pulled` by 1 m at the load factor 1, and guides `guided`
/// along x.
void pull_along_x(Scene& scene, bool guided = true) {
  Boundary pulled = clamp("pulled");
  pulled.displacement = Point3{1, 0, 0};
  pulled.ramp.seconds = 1;
  scene.boundaries = {clamp("fixed"), pulled};
  if (!guided) return;
  Boundary guide = clamp("guided");
  guide.fixed[0] = false;
  scene.boundaries.push_back(guide);
}

double moved(const State<Spatial>& state, std::size_t body) { return displacement(state, body).x; }

/// A chain of 20 equal bars, one of them thinner by a fifth. It softens linearly from F_t = A
/// sigma_t at its elongation e_1 to nothing at s_u e_1, while the others shorten: the ends approach
/// each other, U = e + F (n - 1)/k, and G A is dissipated.
struct Chain {
  static constexpr int n = 20;
  static constexpr double length = 0.05, thin = 0.8, softening = 3;  ///< softening: s_u
  double k(double area) const { return young * area / length; }
  double e1() const { return strength * length / young; }
  double most() const { return strength * thin; }
  double energy() const {  // G: s_u G^-1 A = U_1
    return softening * 0.5 * k(thin) * e1() * e1() / thin;
  }
  double force(double elongation) const {
    const double kappa = elongation / e1();
    return kappa < 1 ? k(thin) * elongation
                     : std::max(0.0, most() * (softening - kappa) / (softening - 1));
  }
  double end(double elongation) const { return elongation + (n - 1) * force(elongation) / k(1); }
};

PathSolution<Spatial> chain_path(const Chain& chain, double growth) {
  std::vector<Point3> places;
  std::vector<Bar> all;
  for (int b = 0; b <= Chain::n; ++b) places.push_back({Chain::length * b, 0, 0});
  for (int m = 0; m < Chain::n; ++m) all.push_back({m, m + 1, m == 7 ? Chain::thin : 1, young});
  Lattice lattice = bars(places, all);
  lattice.sets["fixed"] = {0};
  lattice.sets["pulled"] = {Chain::n};
  lattice.sets["guided"].resize(Chain::n - 1);
  std::iota(lattice.sets["guided"].begin(), lattice.sets["guided"].end(), 1);
  Scene scene = breaking_scene(chain.energy());
  pull_along_x(scene);
  PathOptions<Spatial> options;
  options.growth = growth;
  options.load_factor = 1;
  return follow<Spatial>(scene, lattice, std::move(options));
}

TEST(SofteningChain, SnapsBackOnTheExactLine) {
  const Chain chain;
  std::array<double, 2> released{};
  for (std::size_t r = 0; r < 2; ++r) {
    const auto path = chain_path(chain, r == 0 ? 0.1 : 0.05);
    ASSERT_TRUE(path.result.done) << path.result.message;
    double worst = 0;
    std::int64_t steps = 0;
    for (std::size_t k = 0; k + 1 < path.states.size(); ++k) {
      const double e = moved(path.states[k], 8) - moved(path.states[k], 7);
      const double force = chain.k(1) * moved(path.states[k], 1);
      worst = std::max(
          {worst, std::abs(force - chain.force(e)) / chain.most(),
           std::abs(path.columns[k].at("load_factor") - chain.end(e)) / chain.end(chain.e1())});
      steps += e > 1.001 * chain.e1() ? 1 : 0;
    }
    EXPECT_GE(steps, r == 0 ? 8 : 18);
    EXPECT_GE(path.result.path->snap_backs, steps);
    EXPECT_EQ(path.last("beams_broken"), 1);
    verify({.section = "Paths",
            .quantity = "softening chain: largest error of force and motion on the path",
            .value = worst,
            .reference = 0.0,
            .tolerance = 2e-5,
            .note = text("growth %g; relative to the peak", r == 0 ? 0.1 : 0.05)});
    const double nominal = chain.energy() * Chain::thin;
    verify({.section = "Paths",
            .quantity = "softening chain: dissipated energy over G A",
            .value = path.last("energy_fracture") / nominal,
            .reference = 1.0,
            .tolerance = 1e-4,
            .note = text("growth %g", r == 0 ? 0.1 : 0.05)});
    EXPECT_NEAR(
        path.last("energy_boundary"),
        path.last("energy_strain") + path.last("energy_fracture") + path.last("energy_released"),
        1e-9 * nominal);
    released[r] = std::abs(path.last("energy_released")) / nominal;
  }
  // What the steps cannot resolve.
  EXPECT_LT(released[0], 0.02);
  EXPECT_LT(released[1], 0.6 * released[0]);
}

/// Fibres in parallel behind a spring, of moduli E_k: each breaks at the elongation e_k = L
/// sigma_t/E_k, the stiffest first, when the end is at U_k = e_k + F_k/k_s with F_k = e_k (sum of
/// the stiffnesses of those that still hold). Where U falls from one break to the next the path
/// snaps back.
TEST(BundleOfFibres, BreaksAtTheExactLoads) {
  constexpr std::array<double, 5> moduli{10e9, 8.2e9, 7.9e9, 4e9, 3.6e9};
  constexpr double half = 0.5, area = 0.01, length = 2 * half;
  // Body 0 is held, 1 moves with the fibres, 2 pulls by the spring; 3... are the fibres' middles.
  std::vector<Point3> places{{0, 0, 0}, {length, 0, 0}, {3 * length, 0, 0}};
  std::vector<Bar> all;
  for (std::size_t f = 0; f < moduli.size(); ++f) {
    places.push_back({half, 0, 0});
    all.push_back({0, static_cast<std::int32_t>(3 + f), area, moduli[f]});
  }
  const double spring_area = 1, spring_young = 0.06e9,
               ks = spring_young * spring_area / (2 * length);
  all.push_back({1, 2, spring_area, spring_young});
  for (std::size_t f = 0; f < moduli.size(); ++f)
    all.push_back({1, static_cast<std::int32_t>(3 + f), area, moduli[f]});
  Lattice lattice = bars(places, all);
  lattice.sets["fixed"] = {0};
  lattice.sets["pulled"] = {2};
  lattice.sets["guided"] = {1, 3, 4, 5, 6, 7};
  Scene scene = breaking_scene(1e-3);  // brittle
  pull_along_x(scene);
  PathOptions<Spatial> options;
  options.load_factor = 1;
  const auto path = follow<Spatial>(scene, lattice, std::move(options));
  ASSERT_TRUE(path.result.done) << path.result.message;

  double left = 0;
  for (const double e : moduli) left += e * area / length;
  std::vector<double> at, force;  // at the breaks
  for (const double e : moduli) {
    const double elongation = length * strength / e;
    force.push_back(left * elongation);
    at.push_back(elongation + force.back() / ks);
    left -= e * area / length;
  }
  int falls = 0;
  double worst = 0;
  for (std::size_t f = 0; f < moduli.size(); ++f) {
    // The state in which fibre f is at its strength: the last one with f broken fibres.
    std::size_t state = 0;
    for (std::size_t k = 0; k < path.states.size(); ++k) {
      if (path.columns[k].at("beams_broken") == static_cast<double>(f)) state = k;
    }
    const double u = path.columns[state].at("load_factor");
    const double pull = ks * (u - moved(path.states[state], 1));
    worst = std::max({worst, std::abs(u / at[f] - 1), std::abs(pull / force[f] - 1)});
    const bool falls_here = f > 0 && at[f] < at[f - 1];
    falls += falls_here ? 1 : 0;
    // A fall is one step, from break to break; a rise has elastic states.
    if (falls_here) {
      EXPECT_EQ(path.columns[state].at("snap_back"), 1) << f;
      EXPECT_EQ(path.columns[state - 1].at("beams_broken"), static_cast<double>(f - 1)) << f;
    }
  }
  EXPECT_GE(falls, 2);
  EXPECT_LT(falls, 4);
  EXPECT_EQ(path.result.path->snap_backs, falls);
  verify({.section = "Paths",
          .quantity =
              "bundle of 5 fibres behind a spring: largest error of motion and force at breaks",
          .value = worst,
          .reference = 0.0,
          .tolerance = 1e-5,
          .note = text("%d snap-backs", falls)});
  EXPECT_NEAR(
      path.last("energy_boundary"),
      path.last("energy_strain") + path.last("energy_fracture") + path.last("energy_released"),
      1e-9 * path.last("energy_boundary"));
  EXPECT_GT(path.last("energy_fracture"), 0);
  EXPECT_GT(path.last("energy_released"), 0);
  EXPECT_EQ(path.last("beams_broken"), 5);
}

/// A sheet with a notch at its lower edge, pulled along x at its sides.
Scene notched_sheet(double pull) {
  Scene scene = breaking_scene(15);
  scene.has_sheet = true;
  scene.sheet.length = scene.sheet.width = 20;
  scene.sheet.element_size = 2;
  scene.fracture.propagation = Propagation::energy;
  scene.cuts = {{"notch", {0, -10.1}, {0, -5}}};
  for (const char* side : {"left", "right"}) {
    Boundary b;
    b.name = b.set = side;
    b.fixed = {true, true, true, false, false, false};
    b.displacement = Point3{b.set == "left" ? 0 : pull, 0, 0};
    b.ramp.seconds = 1;
    scene.boundaries.push_back(b);
  }
  return scene;
}

TEST(NotchedSheet, SnapsBackAsItsCrackGrows) {
  constexpr double full = 0.005;
  const Lattice lattice = mesh_of(notched_sheet(full));
  PathOptions<Spatial> options;
  options.load_factor = 1;
  const auto path = follow<Spatial>(notched_sheet(full), lattice, std::move(options));
  ASSERT_TRUE(path.result.done) << path.result.message;
  // With prescribed ends the strain energy is half the load times the displacement.
  const auto load = [&](std::size_t k) {
    return 2 * path.columns[k].at("energy_strain") / (full * path.columns[k].at("load_factor"));
  };
  int snaps = 0;
  double first = 0, first_load = 0;
  for (std::size_t k = 1; k < path.states.size(); ++k) {
    const auto &before = path.columns[k - 1], &now = path.columns[k];
    if (before.at("beams_broken") == 0 && before.at("load_factor") > 0) {
      first = before.at("load_factor");
      first_load = load(k - 1);
    }
    EXPECT_NEAR(now.at("energy_boundary"),
                now.at("energy_strain") + now.at("energy_fracture") + now.at("energy_released"),
                2e-5 * now.at("energy_boundary"))
        << k;
    EXPECT_GE(now.at("energy_fracture"), before.at("energy_fracture"));
    EXPECT_LE(now.at("beams_broken") - before.at("beams_broken"), 1) << k;
    if (now.at("snap_back") == 0) continue;
    ++snaps;
    EXPECT_LT(now.at("load_factor"), before.at("load_factor")) << k;
    EXPECT_LT(load(k), load(k - 1)) << k;
  }
  EXPECT_GE(snaps, 5);
  EXPECT_GE(path.last("beams_broken"), 10);
  // The sheet is nearly in two before its last beams break.
  EXPECT_LT(load(path.states.size() - 2), 0.4 * first_load);
  EXPECT_GT(path.last("energy_released"), 0);
  // Under load control the first beam breaks at the same load, and then the crack runs.
  for (const double part : {0.999, 1.001}) {
    const StaticSolution under = solve_static(notched_sheet(part * first * full), lattice);
    EXPECT_EQ(under.columns.at("beams_broken") > 0, part > 1) << part;
  }
}

}  // namespace
}  // namespace floe::test
