// A notched sheet that is pulled apart: the load at which its crack runs against linear elastic
// fracture mechanics, with the sheet's own compliance.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "support/record.h"
#include "support/static_solution.h"

namespace floe {
namespace {

constexpr double side = 20, h = 1, notch = 5, strength = 6e5;

/// A sheet that is pulled along x by its ends, without cuts.
Scene whole(double element, std::uint64_t seed, double displacement) {
  Scene scene;
  scene.has_sheet = true;
  scene.sheet.length = scene.sheet.width = side;
  scene.sheet.element_size = element;
  scene.sheet.seed = seed;
  scene.thickness = h;
  scene.forces.beam = true;
  scene.beam.kinematics = Kinematics::linear;
  scene.fracture.tensile_strength = scene.fracture.shear_strength = strength;
  scene.fracture.dynamic = false;
  scene.integrator = Integrator::quasistatic;
  for (const char* end : {"left", "right"}) {
    Boundary b;
    b.name = b.set = end;
    b.fixed = {true, true, true, false, false, false};
    b.displacement = Point3{std::string(end) == "left" ? 0 : displacement, 0, 0};
    b.ramp.seconds = 1;
    scene.boundaries.push_back(b);
  }
  return scene;
}

void saw(Scene& scene, const Point2& from, const Point2& to) {
  Cut cut;
  cut.name = "cut" + std::to_string(scene.cuts.size());
  cut.from = from, cut.to = to;
  scene.cuts.push_back(cut);
}

Scene pulled(double element, std::uint64_t seed, double cut_length, double displacement) {
  Scene scene = whole(element, seed, displacement);
  saw(scene, {0, -0.5 * side - 0.1}, {0, -0.5 * side + cut_length});
  return scene;
}

/// Force on the left end [N].
double force_on_left(const Model<Spatial>& model, const Wrenches<Spatial>& wrenches) {
  double force = 0;
  for (const std::int32_t body : model.boundaries()[0].bodies)
    force += wrenches.of(static_cast<std::size_t>(body))[0];
  return std::abs(force);
}

/// Mean stress at which a crack from the notch's end has the energy release rate G_f, by the
/// compliance of the sheet with cuts a little shorter and longer: G = -dU/(h da) at given
/// displacement, U = F u/2. [Pa]
double griffith(double element, std::uint64_t seed, double energy) {
  constexpr double u = 1e-3, step = 2;
  const auto force = [&](double a) {
    const Scene scene = pulled(element, seed, a, u);
    const test::StaticSolution s = test::solve_static(scene, test::mesh_of(scene));
    return force_on_left(*s.model, s.wrenches);
  };
  const double released = 0.5 * u * (force(notch - step) - force(notch + step)) / (h * 2 * step);
  return force(notch) / (side * h) * std::sqrt(energy / released);
}

/// Largest mean stress of a notched sheet [Pa], and its broken area over that of the ligament.
struct Outcome {
  double peak = 0;
  bool apart = false;
};
Outcome pull(Scene scene, double energy, Propagation propagation) {
  scene.forces.fracture = true;
  scene.fracture.energy = scene.fracture.energy_shear = energy;
  scene.fracture.propagation = propagation;
  const Lattice lattice = test::mesh_of(scene);
  Model<Spatial> model(lattice, PETSC_COMM_SELF, scene.boundaries);
  add_forces(scene, {}, model, &lattice);
  hold_free_motions(scene, lattice, model);
  Outcome run;
  const RunResult result = run_quasistatic(model, {1, 0.02}, [&](const Accepted<Spatial>& a) {
    run.peak = std::max(run.peak, force_on_left(model, a.wrenches) / (side * h));
  });
  run.apart = result.done;
  return run;
}

Outcome pull(double element, std::uint64_t seed, double energy, Propagation propagation) {
  return pull(pulled(element, seed, notch, energy > 100 ? 2.5e-3 : 1.5e-3), energy, propagation);
}

/// Mean peak of meshes of seeds 1 to `seeds` over their mean Griffith load. Peaks scatter by 8 %
/// at l = 2 m: the crack follows the cells.
double mean_over_griffith(double element, double energy, Propagation propagation, int seeds) {
  double peaks = 0, loads = 0;
  for (int seed = 1; seed <= seeds; ++seed) {
    const auto s = static_cast<std::uint64_t>(seed);
    peaks += pull(element, s, energy, propagation).peak;
    loads += griffith(element, s, energy);
  }
  return peaks / loads;
}

/// With strengths of tips the notched sheet bears what fracture mechanics says, on any mesh; by the
/// beams' strength it bears several times as much on coarse ones.
TEST(CrackGrowth, ANotchedSheetBearsGriffithsLoadOnAnyMesh) {
  struct Meshes {
    double element;
    int seeds;
  };
  std::vector<Meshes> all{{2, test::full_form() ? 24 : 12}};
  if (test::full_form()) all.insert(all.end(), {{1, 12}, {0.5, 6}});
  for (const auto& [element, seeds] : all)
    test::verify({.section = "Fracture",
                  .quantity = "notched sheet, propagation: energy, l = " +
                              std::to_string(element).substr(0, 3) + " m, " +
                              std::to_string(seeds) + " meshes: mean peak over Griffith's load",
                  .value = mean_over_griffith(element, 15, Propagation::energy, seeds),
                  .reference = 1,
                  .tolerance = 0.1});
  EXPECT_GT(mean_over_griffith(2, 15, Propagation::strength, 2), 2);
}

/// Cracks along the pull and blocks cut out have no crack that opens behind a tip: the load is that
/// of the strengths. Kinks of the cut, half an element high, are cracks of their own; they stay
/// closed here.
TEST(CrackGrowth, CutsAlongThePullAndHolesWeakenNothing) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    if (seed == 3 && !test::full_form()) continue;
    Scene along = whole(2, seed, 2.5e-3), hole = along;
    saw(along, {-5, 0}, {5, 0});
    const std::array<Point2, 5> corners{{{-2, -2}, {2, -2}, {2, 2}, {-2, 2}, {-2, -2}}};
    for (std::size_t k = 0; k < 4; ++k) saw(hole, corners[k], corners[k + 1]);
    for (const Scene& scene : {along, hole}) {
      const double strength_only = pull(scene, 15, Propagation::strength).peak;
      EXPECT_GT(strength_only, 1e5);
      EXPECT_NEAR(pull(scene, 15, Propagation::energy).peak / strength_only, 1, 0.01);
    }
  }
}

/// A sheet of half the thickness that is bent by moments on its ends, with the same notch.
Scene bent(std::uint64_t seed, double cut_length, double moment) {
  Scene scene = whole(1, seed, 0);
  scene.thickness = 0.5;
  scene.boundaries.clear();
  for (const double sign : {1.0, -1.0}) {
    Load load;
    load.name = load.set = sign > 0 ? "left" : "right";
    load.moment = {0, sign * moment, 0};
    load.ramp.seconds = 1;
    scene.loads.push_back(load);
  }
  saw(scene, {0, -0.5 * side - 0.1}, {0, -0.5 * side + cut_length});
  return scene;
}

/// In bending the opening behind the tip is that of Kirchhoff's plate, and a notched sheet breaks
/// at the moment where its strain energy grows by G_f per area at given moments. Fracture mechanics
/// of plates has the crack's faces press at the compressed side; here as there they do not.
TEST(CrackGrowth, ANotchedSheetBendsUntilGriffithsMoment) {
  constexpr double moment = 3e5, step = 2, energy = 15, thickness = 0.5;
  double loads = 0, griffiths = 0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const auto stored = [&](double a) {
      const Scene scene = bent(seed, a, moment);
      return test::solve_static(scene, test::mesh_of(scene)).columns.at("energy_strain");
    };
    griffiths +=
        std::sqrt(energy * thickness * 2 * step / (stored(notch + step) - stored(notch - step)));
    Scene scene = bent(seed, notch, moment);
    scene.forces.fracture = true;
    scene.fracture.energy = scene.fracture.energy_shear = energy;
    scene.fracture.propagation = Propagation::energy;
    const Lattice lattice = test::mesh_of(scene);
    Model<Spatial> model(lattice, PETSC_COMM_SELF, scene.boundaries);
    const std::vector<PlacedLoad> placed = place_loads(scene, lattice);
    add_forces(scene, placed, model, &lattice);
    hold_free_motions(scene, lattice, model);
    double last = 0;
    (void)run_quasistatic(model, {1, 0.05},
                          [&](const Accepted<Spatial>& a) { last = a.state.time; });
    loads += last;  // of the last equilibrium, within a small step of the load that breaks it
  }
  test::verify({.section = "Fracture",
                .quantity =
                    "notched sheet in bending, propagation: energy, l = 1 m, 6 meshes: mean "
                    "moment over Griffith's",
                .value = loads / griffiths,
                .reference = 1,
                .tolerance = 0.1});
}

/// Where nothing breaks the rule changes no bit.
TEST(CrackGrowth, AnIntactSheetIsTheSameBitForBit) {
  std::array<std::vector<double>, 2> records;
  for (const Propagation propagation : {Propagation::strength, Propagation::energy}) {
    Scene scene = pulled(2, 1, notch, 1e-4);
    scene.forces.fracture = true;
    scene.fracture.propagation = propagation;
    records.at(propagation == Propagation::energy ? 1 : 0) =
        test::solve_static(scene, test::mesh_of(scene)).last().records;
  }
  EXPECT_EQ(records[0], records[1]);
}

/// Below l = 2 E G_f/(kappa sigma_t^2) beams at tips have their strength, and nothing changes.
TEST(CrackGrowth, NothingChangesOnFineMeshes) {
  const Outcome strengths = pull(2, 1, 300, Propagation::strength),
                tips = pull(2, 1, 300, Propagation::energy);
  EXPECT_EQ(tips.peak, strengths.peak);
}

}  // namespace
}  // namespace floe
