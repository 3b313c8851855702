// Lattices that break: strips at their theoretical strength, the energy ledger of a sheet that
// falls in two, statics up to and past failure.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "fracture/lanes.h"
#include "fracture_laws/crack_tips.h"
#include "lattice/permute.h"
#include "support/dynamics.h"
#include "support/lattices.h"
#include "support/random.h"
#include "support/record.h"
#include "support/static_solution.h"

namespace floe {
namespace {

constexpr double w = 1.5, h = 0.6, spacing = 1.0, strength = 6e5, young = 4e9;

/// One row of bodies, joined by sections w x h.
Lattice strip(int elements) {
  test::FrameSection section;
  section.area = w * h;
  section.inertia_y = w * h * h * h / 12;
  section.inertia_z = h * w * w * w / 12;
  section.torsion = saint_venant_torsion(w, h);
  section.young = young;
  section.shear_modulus = young / 2.6;
  Lattice lattice = test::straight_frame(spacing * elements, elements, section);
  test::give_mass(lattice, section, 920);
  lattice.beams.width.assign(lattice.beams.bodies.size(), w);
  lattice.beams.height.assign(lattice.beams.bodies.size(), h);
  return lattice;
}

Scene strip_scene() {
  Scene scene;
  scene.forces.beam = scene.forces.fracture = true;
  scene.fracture.dynamic = false;
  scene.fracture.propagation = Propagation::strength;  // a row of beams has no cracks
  scene.time.dt = 0.01;
  Boundary root;
  root.name = root.set = "root";
  root.fixed = {true, true, true, true, true, true};
  root.displacement = Point3{};
  scene.boundaries = {root};
  return scene;
}

struct Failure {
  double load;  ///< factor of the last equilibrium before beams broke
  std::string message;
};

/// Statics under the loads of a scene until no equilibrium is left.
Failure until_failure(const Scene& scene, const Lattice& lattice) {
  const std::vector<PlacedLoad> loads = place_loads(scene, lattice);
  Model<Spatial> model(lattice, PETSC_COMM_SELF, scene.boundaries);
  add_forces(scene, loads, model, &lattice);
  hold_free_motions(scene, lattice, model);
  double last = 0;
  const RunResult result =
      run_quasistatic(model, {scene.time.end, scene.time.dt},
                      [&](const Accepted<Spatial>& a) { last = a.state.time; });
  EXPECT_FALSE(result.done);
  return {last, result.message};
}

Load at_tip(const Point3& force, const Point3& moment) {
  Load load;
  load.name = load.set = "tip";
  load.force = force, load.moment = moment;
  load.ramp.seconds = 1;
  return load;
}

TEST(FractureOfStrips, TensionBreaksAtTheStrengthTimesTheSection) {
  Scene scene = strip_scene();
  scene.loads = {at_tip({1.5 * strength * w * h, 0, 0}, {})};
  const Failure failure = until_failure(scene, strip(8));
  test::verify({.section = "Fracture",
                .quantity = "strip in tension breaks at N/(sigma_t w h)",
                .value = 1.5 * failure.load,
                .reference = 1,
                .tolerance = 1e-2});
  EXPECT_NE(failure.message.find("dynamic failure at load factor 0.66"), std::string::npos)
      << failure.message;
  EXPECT_NE(failure.message.find("continue with integrator: explicit"), std::string::npos);
}

TEST(FractureOfStrips, BendingBreaksAtTheSectionsModulus) {
  for (const double sign : {1.0, -1.0}) {
    Scene scene = strip_scene();
    scene.loads = {at_tip({}, {0, sign * 1.25 * strength * w * h * h / 6, 0})};
    test::verify({.section = "Fracture",
                  .quantity = "strip in bending breaks at M/(sigma_t w h^2/6)",
                  .value = 1.25 * until_failure(scene, strip(8)).load,
                  .reference = 1,
                  .tolerance = 1e-2});
  }
}

TEST(FractureOfStrips, TensionAndBendingAddUp) {
  Scene scene = strip_scene();
  scene.loads = {at_tip({0.5 * strength * w * h, 0, 0}, {0, 0.75 * strength * w * h * h / 6, 0})};
  EXPECT_NEAR(until_failure(scene, strip(1)).load, 0.8, 8e-3);
  scene.loads = {at_tip({-0.5 * strength * w * h, 0, 0}, {0, 1.5 * strength * w * h * h / 6, 0})};
  EXPECT_NEAR(until_failure(scene, strip(1)).load, 1.0, 1e-2);
}

/// N/(sigma_t w h) at which the weakest of a strip's beams breaks, of many seeds: mean and
/// deviation.
std::pair<double, double> scattered_strips(int elements, double modulus, int seeds) {
  const Lattice lattice = strip(elements);
  const Part part = partition(lattice, PETSC_COMM_SELF);
  BeamOptions beams;
  beams.kinematics = Kinematics::linear;
  State<Spatial> stretched(static_cast<std::size_t>(part.local));  // every beam at sigma_t
  for (std::size_t b = 0; b < static_cast<std::size_t>(part.local); ++b) {
    double* r = stretched.record(b);
    r[0] = strength / young * part.bodies.position[b][0];
    r[3] = 1;
  }
  double sum = 0, squares = 0;
  for (int seed = 1; seed <= seeds; ++seed) {
    FractureOptions options;
    options.propagation = Propagation::strength;
    options.tensile_strength = options.shear_strength = strength;
    options.weibull_modulus = modulus;
    options.seed = static_cast<std::uint64_t>(seed);
    const double broken_at =
        1 / make_breakable_beams(part, beams, options).fracture->overload(stretched);
    sum += broken_at, squares += broken_at * broken_at;
  }
  const double mean = sum / seeds;
  return {mean, std::sqrt((squares - seeds * mean * mean) / (seeds - 1))};
}

/// Links in series: the least of n strengths of Weibull's distribution has the same distribution,
/// n^(-1/m) as large.
TEST(FractureOfStrips, WeibullsSizeEffectOfTheWeakestLink) {
  constexpr int seeds = 800;
  for (const double m : {3.0, 6.0}) {
    const double g1 = std::tgamma(1 + 1 / m), g2 = std::tgamma(1 + 2 / m);
    const double variation = std::sqrt(g2 / (g1 * g1) - 1);
    for (const int n : {1, 10, 100}) {
      const auto [mean, deviation] = scattered_strips(n, m, seeds);
      const double exact = std::pow(n, -1 / m);
      test::verify({.section = "Fracture",
                    .quantity = "mean strength of strips of " + std::to_string(n) +
                                " beams over (1/n)^(1/m), Weibull's m = " +
                                std::to_string(static_cast<int>(m)),
                    .value = mean / exact,
                    .reference = 1,
                    .tolerance = 3 * variation / std::sqrt(seeds)});
      EXPECT_NEAR(deviation / mean / variation, 1, 0.12) << n;
    }
  }
}

/// Pulled by displacement, a strip of short beams softens along a static path: the reaction falls
/// to nothing, and the boundary's work is the fracture energy of one section.
TEST(FractureOfStrips, DisplacementControlFollowsTheSoftening) {
  constexpr double short_beam = 0.05;
  Lattice lattice = strip(2);
  for (std::size_t b = 0; b < lattice.bodies.position.size(); ++b)
    lattice.bodies.position[b][0] *= short_beam / spacing;
  for (double& length : lattice.beams.length) length = short_beam;
  lattice.beams.width[1] *= 0.98;  // the weaker one
  lattice.beams.area[1] *= 0.98;
  Scene scene = strip_scene();
  Boundary tip = scene.boundaries[0];
  tip.name = tip.set = "tip";
  tip.displacement = Point3{1.4 * 2 * 15 / strength, 0, 0};
  tip.ramp.seconds = 1;
  scene.boundaries.push_back(tip);
  const test::StaticSolution s = test::solve_static(scene, lattice);
  ASSERT_TRUE(s.result.done) << s.result.message;
  const double fracture = s.columns.at("energy_fracture"), strain = s.columns.at("energy_strain"),
               broken = s.columns.at("beams_broken");
  EXPECT_EQ(broken, 1);
  const double nominal = 15 * 0.98 * w * h;
  EXPECT_NEAR(fracture, nominal, 1e-2 * nominal);
  EXPECT_LT(strain, 1e-9 * nominal);
}

/// A strip of 40 short beams snaps back when its weakest beam has reached its strength: the beam
/// dissipates G A, and the rest of what the boundaries put in, 1/2 k u^2, is released.
TEST(FractureOfStrips, WhatNoBeamDissipatesIsReleased) {
  constexpr double short_beam = 0.05, narrow = 0.98;
  constexpr int elements = 40;
  Lattice lattice = strip(elements);
  for (Point3& place : lattice.bodies.position) place[0] *= short_beam / spacing;
  for (double& length : lattice.beams.length) length = short_beam;
  lattice.beams.width[17] *= narrow;
  lattice.beams.area[17] *= narrow;
  Scene scene = strip_scene();
  scene.beam.kinematics = Kinematics::linear;
  Boundary tip = scene.boundaries[0];
  tip.name = tip.set = "tip";
  tip.displacement = Point3{1.2 * elements * short_beam * strength / young, 0, 0};
  tip.ramp.seconds = 1;
  scene.boundaries.push_back(tip);
  Model<Spatial> model(lattice, PETSC_COMM_SELF, scene.boundaries);
  add_forces(scene, {}, model, &lattice);
  double stretch = 0, fracture = 0, released = 0, broken = 0;
  const RunResult run = run_quasistatic(model, {1, 0.01}, [&](const Accepted<Spatial>& a) {
    const bool whole = broken == 0;
    for (const auto& [name, value] : a.forces) {
      if (name == "energy_fracture") fracture = value;
      if (name == "energy_released") released = value;
      if (name == "beams_broken") broken = value;
    }
    if (whole) stretch = a.state.time * (*tip.displacement)[0];  // up to the break
  });
  ASSERT_TRUE(run.done) << run.message;
  ASSERT_EQ(broken, 1);
  const double nominal = 15 * narrow * w * h;
  const double k = young * w * h / (short_beam * (elements - 1 + 1 / narrow));
  EXPECT_NEAR(fracture, nominal, 1e-9 * nominal);
  EXPECT_NEAR(fracture + released, 0.5 * k * stretch * stretch, 1e-9 * nominal);
  EXPECT_GT(released, nominal);
}

/// A load on the middle of two beams breaks the one that it stretches; the other one holds it. The
/// load works while the beam breaks.
TEST(FractureOfStrips, TheLedgerOfStaticsClosesUnderLoads) {
  Lattice lattice = strip(2);
  lattice.sets["middle"] = {1};
  Scene scene = strip_scene();
  scene.beam.kinematics = Kinematics::linear;
  Boundary tip = scene.boundaries[0];
  tip.name = tip.set = "tip";
  scene.boundaries.push_back(tip);
  Load load = at_tip({3 * strength * w * h, 0, 0}, {0, 0.1 * strength * w * h * h / 6, 0});
  load.set = "middle";
  scene.loads = {load};
  const test::StaticSolution s = test::solve_static(scene, lattice);
  ASSERT_TRUE(s.result.done) << s.result.message;
  EXPECT_EQ(s.columns.at("beams_broken"), 1);
  const double external = s.columns.at("energy_external");
  EXPECT_GT(s.columns.at("energy_released"), 0.1 * s.columns.at("energy_fracture"));
  EXPECT_NEAR(s.columns.at("energy_strain") + s.columns.at("energy_fracture") +
                  s.columns.at("energy_released"),
              external, 1e-9 * external);
}

/// A sheet pulled apart: 24 x 12 m of bodies of 1.5 m.
struct Pulled {
  double external = 0, fracture = 0, error = 0;
  double fragments_moved = 0, broken = 0, stable = 0;
};
Pulled pull(double damping, double safety) {
  Lattice lattice = test::sheet(24, 12, 1.5);
  reorder(lattice);
  Scene scene;
  scene.forces.beam = scene.forces.fracture = true;
  scene.beam.damping_ratio = damping;
  for (const char* side : {"left", "right"}) {
    Boundary b;
    b.name = b.set = side;
    b.fixed[0] = true;
    b.velocity = Point3{std::string(side) == "left" ? 0 : 0.2, 0, 0};
    b.ramp.seconds = 0.05;
    scene.boundaries.push_back(b);
  }
  Model<Spatial> model(lattice, PETSC_COMM_SELF, scene.boundaries);
  add_forces(scene, {}, model, &lattice);
  ExplicitOptions options;
  options.end = 0.1;
  options.safety = safety;
  options.energy_limit = 1;
  options.history = 0.01;
  Pulled result;
  const RunResult run = run_explicit(model, options, [&](const Accepted<Spatial>& a) {
    for (const auto* list : {&a.columns, &a.forces}) {
      for (const auto& [name, value] : *list) {
        if (name == "energy_boundary") result.external = value;
        if (name == "energy_fracture") result.fracture = value;
        if (name == "energy_balance_error") result.error = std::abs(value);
        if (name == "beams_broken") result.broken = value;
      }
    }
  });
  EXPECT_TRUE(run.done) << run.message;
  EXPECT_GT(result.broken, 10);
  return result;
}

TEST(FractureOfSheets, IntactBreakableBeamsAreBeams) {
  const Lattice lattice = test::sheet(12, 9, 1);
  const Part part = partition(lattice, PETSC_COMM_SELF);
  BeamOptions beams;
  beams.damping_ratio = 0.3;
  const auto plain = make_beam_force<Spatial>(part, beams);
  const auto breakable = make_breakable_beams(
      part, beams,
      {.tensile_strength = 1e12, .shear_strength = 1e12, .propagation = Propagation::energy},
      find_junctions(lattice, Shear::one_point));
  State<Spatial> state(static_cast<std::size_t>(part.local));
  test::Random random(3);
  for (std::size_t b = 0; b < static_cast<std::size_t>(part.local); ++b) {
    double* r = state.record(b);
    for (int k = 0; k < 3; ++k) r[k] = random.uniform(-1e-3, 1e-3);
    const Quat<double> q = random.rotation(1e-3);
    r[3] = q.w, r[4] = q.x, r[5] = q.y, r[6] = q.z;
    for (int k = 7; k < 13; ++k) r[k] = random.uniform(-1, 1);
  }
  Wrenches<Spatial> a(static_cast<std::size_t>(part.local)), b = a;
  plain->add(state, a);
  breakable.force->add(state, b);
  double size = 0, difference = 0;
  for (std::size_t k = 0; k < a.values.size(); ++k) {
    size = std::max(size, std::abs(a.values[k]));
    difference = std::max(difference, std::abs(a.values[k] - b.values[k]));
  }
  EXPECT_GT(size, 0);
  EXPECT_LT(difference, 1e-14 * size);
}

/// Moves bodies apart in strips of 3 m, or all a little at random.
State<Spatial> moved(const Lattice& lattice, double apart, double random_size) {
  State<Spatial> state(lattice.bodies.position.size());
  test::Random random(5);
  for (std::size_t b = 0; b < lattice.bodies.position.size(); ++b) {
    double* r = state.record(b);
    r[0] = apart * std::floor(lattice.bodies.position[b][0] / 3);
    for (int k = 0; k < 3; ++k) r[k] += random.uniform(-random_size, random_size);
    const Quat<double> q = random.rotation(random_size);
    r[3] = q.w, r[4] = q.x, r[5] = q.y, r[6] = q.z;
    for (int k = 7; k < 13; ++k) r[k] = random_size * random.uniform(-1, 1);
  }
  return state;
}

/// Beams that have broken move to the ends of their groups of blocks. The others do what they do in
/// a lattice that never had the broken ones, bit for bit, since each body sums its beams in their
/// order.
TEST(FractureOfSheets, BrokenBeamsLeaveNoTrace) {
  Lattice lattice = test::sheet(24, 18, 1);
  reorder(lattice);
  BeamOptions beams;
  beams.damping_ratio = 0.3;
  for (const double crushing : {0.0, 4e6}) {  // both criteria
    const FractureOptions options{.compressive_strength = crushing,
                                  .propagation = Propagation::strength};
    const Part part = partition(lattice, PETSC_COMM_SELF);
    const auto torn = make_breakable_beams(part, beams, options);
    const State<Spatial> apart = moved(lattice, 0.5, 0), later = moved(lattice, 0, 1e-6);
    Wrenches<Spatial> found(apart.records.size() / Spatial::record);
    torn.force->add(apart, found);
    torn.force->roles().commits->commit(apart, 1e-5);
    std::vector<std::int32_t> left;
    for (std::int32_t m = 0; m < part.beams.size(); ++m) {
      const double damage = torn.fracture->damage(m);
      EXPECT_TRUE(damage == 0 || damage == 1);
      if (damage == 0) left.push_back(m);
    }
    ASSERT_GT(left.size(), part.beams.bodies.size() / 3);
    ASSERT_LT(left.size(), part.beams.bodies.size() - 100);

    Lattice less = lattice;
    permute(less.beams, left);
    const Part part_less = partition(less, PETSC_COMM_SELF);
    const auto whole = make_breakable_beams(part_less, beams, options);
    Wrenches<Spatial> expected = Wrenches<Spatial>(found.values.size() / Spatial::wrench);
    std::fill(found.values.begin(), found.values.end(), 0.0);
    torn.force->add(later, found);
    whole.force->add(later, expected);
    double size = 0;
    for (std::size_t k = 0; k < found.values.size(); ++k) {
      EXPECT_EQ(found.values[k], expected.values[k]);
      size = std::max(size, std::abs(found.values[k]));
    }
    EXPECT_GT(size, 0);
    const std::vector<BeamSection> all = torn.force->sections(later),
                                   some = whole.force->sections(later);
    for (std::size_t k = 0; k < left.size(); ++k)
      EXPECT_EQ(all[static_cast<std::size_t>(left[k])], some[k]);
  }
}

/// The strain energy from which on strengths are looked at misses no beam: whatever the forces, s^2
/// is at most the energy times its bound, and reaches it.
TEST(FractureOfSheets, TheBoundByTheEnergyHoldsAndIsReached) {
  test::Random random(6);
  for (const bool crushes : {false, true}) {
    double nearest = 0;
    for (int repeat = 0; repeat < 20000; ++repeat) {
      const auto positive = [&] { return random.uniform(0.2, 2); };
      BeamConstants<double> beam{};
      beam.kn = positive(), beam.ksz = positive(), beam.ksy = positive();
      beam.kt = positive(), beam.kby = positive(), beam.kbz = positive();
      const Strength<double> s{positive(), positive(), positive(), positive(), positive()};
      const FurtherStrength<double> further{positive(), positive(), random.uniform(-0.9, 0.9)};
      const auto any = [&] { return random.uniform(-1, 1) * (random.uniform(0, 1) < 0.5 ? 0 : 1); };
      const BeamStress<double> strain{any(), any(), any(), {any(), any(), any()}};
      const BeamStress<double> force{
          beam.kn * strain.n,
          beam.ksz * strain.qy,
          beam.ksy * strain.qz,
          {beam.kt * strain.c.x, beam.kby * strain.c.y, beam.kbz * strain.c.z}};
      const double twice = 2 * damage_energy(force, strain).whole();
      const Criteria<double> s2 = criteria(s, further, force, crushes);
      const double bound = twice * overload_per_energy(beam, s, &further, crushes);
      EXPECT_LE(std::max(s2.tension, s2.pressure), bound * (1 + 1e-12));
      EXPECT_LE(criterion(s, force),
                twice * overload_per_energy(beam, s, nullptr, false) * (1 + 1e-12));
      if (bound > 0) nearest = std::max(nearest, std::max(s2.tension, s2.pressure) / bound);
    }
    EXPECT_GT(nearest, 0.9);
  }
}

TEST(FractureOfSheets, TheLedgerCloses) {
  for (const double damping : {0.0, 0.1}) {
    const Pulled automatic = pull(damping, 0.9), fine = pull(damping, 0.1),
                 finer = pull(damping, 0.05);
    const std::string with = damping > 0 ? ", damping_ratio 0.1" : ", undamped";
    test::verify({.section = "Fracture",
                  .quantity = "error of the ledger over the external work, sheet pulled "
                              "apart, dt auto" +
                              with,
                  .value = automatic.error / automatic.external,
                  .reference = 0,
                  .tolerance = 1e-2});
    test::verify(
        {.section = "Fracture",
         .quantity = "the same over the fracture energy, a tenth of the stable step" + with,
         .value = fine.error / fine.fracture,
         .reference = 0,
         .tolerance = 2e-2});
    constexpr double rounding = 1e-6;  // dashpots' forces are kept as floats
    EXPECT_LT(fine.error / fine.fracture, std::max(automatic.error / automatic.fracture, rounding));
    EXPECT_LT(finer.error / finer.fracture, std::max(fine.error / fine.fracture, rounding));
  }
}

}  // namespace
}  // namespace floe
