// Strength of whole sheets: calibrated ones have the given strength; Weibull's size effect.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "support/record.h"
#include "support/static_solution.h"

namespace floe {
namespace {

constexpr double strength = 6e5;

/// Mean stress over sigma_t at which a sheet's first beam breaks when its ends are pulled along an
/// axis, by statics in space; the last state before the break, extrapolated to it.
double first_break(Scene scene, const Lattice& lattice, std::size_t axis) {
  const bool along_x = axis == 0;
  for (const char* side : {along_x ? "left" : "bottom", along_x ? "right" : "top"}) {
    Boundary b;
    b.name = b.set = side;
    b.fixed[axis] = true;
    b.displacement = Point3{};
    if (!scene.boundaries.empty()) (*b.displacement)[axis] = 2.2e-4 * scene.sheet.length;
    b.ramp.seconds = 1;
    scene.boundaries.push_back(b);
  }
  Model<Spatial> model(lattice, PETSC_COMM_SELF, scene.boundaries);
  add_forces(scene, {}, model);
  hold_free_motions(scene, lattice, model);
  double stress = 0;
  (void)run_quasistatic(model, {1, 0.05}, [&](const Accepted<Spatial>& a) {
    if (!model.fracture()->breaks().empty() || a.state.time == 0) return;
    double force = 0;
    for (const std::int32_t body : model.boundaries()[0].bodies)
      force += a.wrenches.of(static_cast<std::size_t>(body))[axis];
    const double across = along_x ? scene.sheet.width : scene.sheet.length;
    stress = std::abs(force) / (across * scene.thickness) / model.fracture()->overload(a.state);
  });
  return stress / scene.fracture.tensile_strength;
}

/// A sheet whose beams are as strong as its calibration says breaks at the given strength.
TEST(FractureOfSheets, ACalibratedSheetHasTheGivenStrength) {
  Scene scene;
  scene.has_sheet = true;
  scene.sheet = {15, 12, 1, 4, Relaxation::lloyd, 50, 0};
  scene.thickness = 0.5;
  scene.forces.beam = scene.forces.fracture = true;
  scene.beam.kinematics = Kinematics::linear;
  scene.fracture.dynamic = false;
  scene.fracture.calibrate = true;
  scene.fracture.shear_strength = 4e5;
  MeshReport report;
  const Lattice lattice = make_lattice(scene, PETSC_COMM_SELF, report);
  ASSERT_TRUE(report.strength.has_value());
  const double factor = report.strength->factor;
  EXPECT_GT(factor, 1.1);
  const double given = scene.fracture.tensile_strength;
  strengthen(scene, *report.strength);
  EXPECT_DOUBLE_EQ(scene.fracture.tensile_strength, factor * given);
  EXPECT_DOUBLE_EQ(scene.fracture.shear_strength, factor * 4e5);
  const double x = first_break(scene, lattice, 0) * factor,
               y = first_break(scene, lattice, 1) * factor;
  EXPECT_NEAR(x / (factor * report.strength->along_x), 1, 1e-5);
  EXPECT_NEAR(y / (factor * report.strength->along_y), 1, 1e-5);
  for (const double along : {x, y})
    test::verify({.section = "Fracture",
                  .quantity = "calibrated sheet's first break over sigma_t, along one axis",
                  .value = along,
                  .reference = 1,
                  .tolerance = 0.08});
  test::verify({.section = "Fracture",
                .quantity = "the same, mean of x and y",
                .value = (x + y) / 2,
                .reference = 1,
                .tolerance = 1e-5});
}

/// Strength at the first break, over sigma_t, of a square sheet pulled by its ends whose beams
/// scatter.
struct ScatteredSheet {
  double measured;  ///< mean over seeds of the scatter
  double exact;     ///< mean over all seeds: [sum (A_i/A_ref) s_i^m]^(-1/m), s_i at unit stress
};
ScatteredSheet scattered_sheet(double length, double modulus, int seeds) {
  Scene scene;
  scene.has_sheet = true;
  scene.sheet = {length, length, 1, 2, Relaxation::lloyd, 50, 0};
  scene.thickness = 0.5;
  scene.forces.beam = true;
  scene.beam.kinematics = Kinematics::linear;
  for (const char* side : {"left", "right"}) {
    Boundary b;
    b.name = b.set = side;
    b.fixed[0] = true;
    b.displacement = Point3{std::string(side) == "left" ? 0 : 1e-4 * length, 0, 0};
    scene.boundaries.push_back(b);
  }
  const Lattice lattice = test::mesh_of(scene);
  const test::StaticSolution s = test::solve_static(scene, lattice);
  double force = 0;
  for (const std::int32_t body : s.model->boundaries()[0].bodies)
    force += s.wrenches.of(static_cast<std::size_t>(body))[0];
  const double stress = std::abs(force) / (length * scene.thickness) / strength;

  const Part& part = s.model->part();
  const std::vector<BeamSection> sections = s.model->beams()->sections(s.last());
  double mean_area = 0, links = 0;
  for (const double area : part.beams.area)
    mean_area += area / static_cast<double>(part.beams.area.size());
  for (std::size_t m = 0; m < sections.size(); ++m) {
    const auto& [n, qy, qz, torque, my, mz] = sections[m];
    const double area = part.beams.area[m];
    const double tension = n / area + std::abs(mz) * 6 / (area * part.beams.width[m]);
    const double at_unit = std::hypot(std::max(0.0, tension), qy / area) / strength / stress;
    links += area / mean_area * std::pow(at_unit, modulus);
  }
  double sum = 0;
  for (int seed = 1; seed <= seeds; ++seed) {
    FractureOptions options;
    options.tensile_strength = options.shear_strength = strength;
    options.weibull_modulus = modulus;
    options.seed = static_cast<std::uint64_t>(seed);
    sum += stress / make_breakable_beams(part, scene.beam, options).fracture->overload(s.last());
  }
  return {sum / seeds, std::pow(links, -1 / modulus)};
}

/// Sheets are chains of many links with unequal stresses: the first break is Weibull's weakest
/// link exactly, and falls as (A_0/A)^(1/m) as far as larger sheets are more of the same.
TEST(FractureOfSheets, WeibullsSizeEffectOfTheFirstBreak) {
  constexpr int seeds = 400;
  for (const double m : {3.0, 6.0}) {
    const double g1 = std::tgamma(1 + 1 / m);
    const double variation = std::sqrt(std::tgamma(1 + 2 / m) / (g1 * g1) - 1);
    std::vector<double> strengths;
    for (const double length : {10.0, 20.0, 40.0}) {
      const ScatteredSheet sheet = scattered_sheet(length, m, seeds);
      EXPECT_NEAR(sheet.measured / sheet.exact, 1, 3 * variation / std::sqrt(seeds)) << length;
      strengths.push_back(sheet.exact);
    }
    test::verify({.section = "Fracture",
                  .quantity = "first break of sheets, slope of log strength over log area from "
                              "L/l = 10 to 40, times -m; Weibull's m = " +
                              std::to_string(static_cast<int>(m)),
                  .value = -m * std::log(strengths[2] / strengths[0]) / std::log(16.0),
                  .reference = 1,
                  .tolerance = 0.1});
  }
}

}  // namespace
}  // namespace floe
