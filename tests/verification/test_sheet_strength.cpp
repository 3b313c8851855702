// Strength of whole sheets: calibrated ones have the given strength; Weibull's size effect.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "fracture_laws/strengths.h"
#include "support/record.h"
#include "support/static_solution.h"

namespace floe {
namespace {

constexpr double strength = 6e5;

/// Largest s of the beams of a state that touch no body of the given sets.
double worst_outside(const Scene& scene, const Lattice& lattice, const Model<Spatial>& model,
                     const State<Spatial>& state, const std::vector<std::string>& sets) {
  std::vector<bool> excluded(lattice.bodies.position.size(), false);
  for (const std::string& set : sets) {
    for (const std::int32_t body : lattice.sets.at(set)) excluded[std::size_t(body)] = true;
  }
  std::vector<BeamSection> sections = model.beams()->sections(state);
  for (std::size_t m = 0; m < sections.size(); ++m) {
    const auto [i, j] = model.part().beams.bodies[m];
    if (excluded[std::size_t(i)] || excluded[std::size_t(j)]) sections[m] = {};
  }
  return overload(model.part(), sections, scene.fracture);
}

/// Nominal stress at which a sheet's first beam breaks when the ends are pulled along an axis or
/// bent against each other (there: first beam away from them), by statics in space; the last state
/// before any break, extrapolated [Pa].
double first_break(Scene scene, const Lattice& lattice, std::size_t axis, bool bends = false) {
  const bool along_x = axis == 0;
  const std::vector<std::string> ends{along_x ? "left" : "bottom", along_x ? "right" : "top"};
  const double h = scene.thickness, across = along_x ? scene.sheet.width : scene.sheet.length;
  const double given = scene.fracture.flexural_strength;
  const double motion =
      2.2e-4 * scene.sheet.length * (bends ? (given > 0 ? given / strength : 1) / h : 1);
  for (const std::string& end : ends) {
    Boundary b;
    b.name = b.set = end;
    b.fixed[bends ? 4 - axis : axis] = true;
    b.ramp.seconds = 1;
    if (bends) {
      b.angular_velocity[1 - axis] = scene.boundaries.empty() ? -motion : motion;
    } else {
      b.displacement = Point3{};
      if (!scene.boundaries.empty()) (*b.displacement)[axis] = motion;
    }
    scene.boundaries.push_back(b);
  }
  Model<Spatial> model(lattice, PETSC_COMM_SELF, scene.boundaries);
  add_forces(scene, {}, model, &lattice);
  hold_free_motions(scene, lattice, model);
  double stress = 0;
  (void)run_quasistatic(
      model, {bends ? 0.5 : 1, bends ? 0.25 : 0.05}, [&](const Accepted<Spatial>& a) {
        for (std::int32_t m = 0; m < model.part().beams.size(); ++m) {
          if (model.fracture()->damage(m) > 0) return;
        }
        if (a.state.time == 0) return;
        EXPECT_NEAR(worst_outside(scene, lattice, model, a.state, {}),
                    model.fracture()->overload(a.state), 1e-9);
        double force = 0;
        for (const std::int32_t body : model.boundaries()[0].bodies)
          force += a.wrenches.of(static_cast<std::size_t>(body))[bends ? 4 - axis : axis];
        stress = std::abs(force) / (across * h * (bends ? h / 6 : 1)) /
                 worst_outside(scene, lattice, model, a.state,
                               bends ? ends : std::vector<std::string>{});
      });
  return stress;
}

/// A sheet with fracture, its beams' strengths calibrated as the scene says.
struct CalibratedSheet {
  Scene scene;
  Lattice lattice;
  StrengthCalibration calibration;
  Scene uncalibrated;
};
CalibratedSheet calibrated_sheet(double length, double width, int seed, bool tension,
                                 double flexural, Calibrate stiffness) {
  CalibratedSheet sheet;
  Scene& scene = sheet.scene;
  scene.has_sheet = true;
  scene.sheet = {length, width, 1, static_cast<std::uint64_t>(seed), Relaxation::lloyd, 50, 0};
  scene.thickness = 0.5;
  scene.forces.beam = scene.forces.fracture = true;
  scene.beam.kinematics = Kinematics::linear;
  scene.calibrate = stiffness;
  scene.fracture.dynamic = false;
  scene.fracture.calibrate = tension;
  scene.fracture.shear_strength = 4e5;
  scene.fracture.flexural_strength = flexural;
  sheet.uncalibrated = scene;
  MeshReport report;
  sheet.lattice = make_lattice(scene, PETSC_COMM_SELF, report);
  sheet.calibration = report.strength.value();
  strengthen(scene, sheet.calibration);
  return sheet;
}

/// A sheet whose beams are as strong as its calibration says breaks at the given strength.
TEST(FractureOfSheets, ACalibratedSheetHasTheGivenStrength) {
  const CalibratedSheet sheet = calibrated_sheet(15, 12, 4, true, 0, Calibrate::none);
  const StrengthCalibration& c = sheet.calibration;
  EXPECT_GT(c.factor, 1.1);
  const FractureOptions &given = sheet.uncalibrated.fracture, &own = sheet.scene.fracture;
  EXPECT_DOUBLE_EQ(own.tensile_strength, c.factor * given.tensile_strength);
  EXPECT_DOUBLE_EQ(own.shear_strength, c.factor * 4e5);
  const double x = first_break(sheet.scene, sheet.lattice, 0) / strength,
               y = first_break(sheet.scene, sheet.lattice, 1) / strength;
  EXPECT_NEAR(x / (c.factor * c.tension->along_x), 1, 1e-5);
  EXPECT_NEAR(y / (c.factor * c.tension->along_y), 1, 1e-5);
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
  // Bending: as strong as in tension, as nothing else is said.
  const double bent = (first_break(sheet.scene, sheet.lattice, 0, true) +
                       first_break(sheet.scene, sheet.lattice, 1, true)) /
                      2;
  EXPECT_NEAR(bent / strength, 1, 1e-5);
}

/// Flexural strength alone: tension keeps the beams' own strength, bending has the given one.
TEST(FractureOfSheets, TheFlexuralStrengthIsThatOfAUniformMoment) {
  for (const Calibrate stiffness : {Calibrate::none, Calibrate::isotropic}) {
    for (const double given : {3e5, 9e5}) {
      const CalibratedSheet sheet = calibrated_sheet(15, 12, 2, false, given, stiffness);
      EXPECT_EQ(sheet.calibration.factor, 1);
      EXPECT_FALSE(sheet.calibration.tension.has_value());
      const double x = first_break(sheet.scene, sheet.lattice, 0, true),
                   y = first_break(sheet.scene, sheet.lattice, 1, true);
      test::verify({.section = "Fracture",
                    .quantity = test::text(
                        "first break in bending over the flexural strength of "
                        "%.1f MPa, mean of x and y; stiffnesses %s",
                        given / 1e6, stiffness == Calibrate::none ? "as they are" : "isotropic"),
                    .value = (x + y) / 2 / given,
                    .reference = 1,
                    .tolerance = 1e-5});
      EXPECT_NEAR(x / y, 1, 0.08);
      EXPECT_EQ(first_break(sheet.scene, sheet.lattice, 0),
                first_break(sheet.uncalibrated, sheet.lattice, 0));
    }
  }
}

/// Names the bodies around some places x.
void name_line(Lattice& lattice, const std::string& name, std::vector<double> places) {
  std::vector<std::int32_t>& set = lattice.sets[name];
  for (std::int32_t b = 0; b < lattice.bodies.size(); ++b) {
    for (const double x : places) {
      if (std::abs(lattice.bodies.position[std::size_t(b)].x - x) < 0.5) set.push_back(b);
    }
  }
}

/// Nominal stress at the first break between the loads of four-point bending [Pa]: supports and
/// loads are lines of bodies, whose own beams and neighbours do not count.
double four_point(const CalibratedSheet& sheet) {
  Lattice lattice = sheet.lattice;
  constexpr double outer = 10, inner = 5;
  name_line(lattice, "supports", {-outer, outer});
  name_line(lattice, "loads", {-inner, inner});
  std::vector<std::int32_t>& outside = lattice.sets["outside"];
  for (std::int32_t b = 0; b < lattice.bodies.size(); ++b) {
    if (std::abs(lattice.bodies.position[std::size_t(b)].x) > inner - 2) outside.push_back(b);
  }
  Scene test;
  test.forces.beam = true;
  test.beam = sheet.scene.beam;
  test.time.end = 1;
  test.time.dt = 0;
  Boundary b;
  b.name = b.set = "supports";
  b.fixed[2] = true;
  test.boundaries = {b};
  Load load;
  load.name = load.set = "loads";
  load.force = {0, 0, -1e4};
  test.loads = {load};
  const test::StaticSolution s = test::solve_static(test, lattice);
  double moment = 0;  // at x = 0, of the forces on the right half
  const double share = load.force.z / static_cast<double>(lattice.sets.at("loads").size());
  for (const std::int32_t body : lattice.sets.at("loads"))
    moment += share * std::max(0.0, lattice.bodies.position[std::size_t(body)].x);
  for (const std::int32_t body : lattice.sets.at("supports"))
    moment -= s.wrenches.of(std::size_t(body))[2] *
              std::max(0.0, lattice.bodies.position[std::size_t(body)].x);
  const double h = sheet.scene.thickness;
  return std::abs(moment) / (sheet.scene.sheet.width * h * h / 6) /
         worst_outside(sheet.scene, lattice, *s.model, s.last(), {"outside"});
}

/// Nominal stress 6 F x/(b h^2) at the worst beam of a cantilever that is held at its left end and
/// loaded at its right one, at the first break; x the distance from the load to the beam's middle.
double cantilever(const CalibratedSheet& sheet) {
  const Lattice& lattice = sheet.lattice;
  Scene test;
  test.forces.beam = true;
  test.beam = sheet.scene.beam;
  test.time.end = 1;
  test.time.dt = 0;
  Boundary b;
  b.name = b.set = "left";
  b.fixed = {true, true, true, true, true, true};
  test.boundaries = {b};
  Load load;
  load.name = load.set = "right";
  load.force = {0, 0, -1e4};
  test.loads = {load};
  const test::StaticSolution s = test::solve_static(test, lattice);
  double at_load = 0;
  for (const std::int32_t body : lattice.sets.at("right"))
    at_load += lattice.bodies.position[std::size_t(body)].x /
               static_cast<double>(lattice.sets.at("right").size());
  const Part& part = s.model->part();
  const std::vector<BeamSection> sections = s.model->beams()->sections(s.last());
  double worst = 0, place = 0;
  for (std::size_t m = 0; m < sections.size(); ++m) {
    std::vector<BeamSection> one(sections.size());
    one[m] = sections[m];
    const double s_one = overload(part, one, sheet.scene.fracture);
    if (s_one < worst) continue;
    worst = s_one;
    place = 0;
    for (const std::int32_t body : part.beams.bodies[m])
      place += lattice.bodies.position[std::size_t(body)].x / 2;
  }
  const double h = sheet.scene.thickness;
  return 1e4 * (at_load - place) / (sheet.scene.sheet.width * h * h / 6) / worst;
}

/// What the definition does not look at: four-point bending and cantilevers of calibrated sheets
/// break at the flexural strength too, within what meshes scatter by. A held root cannot curve
/// across, and beams feel curvatures: there a sheet with Poisson's ratio nu_b in bending bears
/// 1/(1 - nu_b^2) times as much.
TEST(FractureOfSheets, FourPointBendingAndCantileversBreakAtTheFlexuralStrength) {
  const int seeds = test::full_form() ? 10 : 4;
  for (const Calibrate stiffness : {Calibrate::none, Calibrate::isotropic}) {
    std::vector<double> points, roots;
    for (int seed = 1; seed <= seeds; ++seed) {
      points.push_back(four_point(calibrated_sheet(24, 6, seed, true, 5e5, stiffness)) / 5e5);
      roots.push_back(cantilever(calibrated_sheet(12, 6, seed, true, 5e5, stiffness)) / 5e5);
    }
    const bool isotropic = stiffness == Calibrate::isotropic;
    const auto compare = [&](const char* what, const std::vector<double>& all, double reference) {
      double mean = 0, variance = 0;
      for (const double one : all) mean += one / seeds;
      for (const double one : all) variance += (one - mean) * (one - mean) / (seeds - 1);
      test::verify({.section = "Fracture",
                    .quantity = test::text("%s over the flexural strength, stiffnesses %s, mean of "
                                           "%d meshes (deviation %.3f)",
                                           what, isotropic ? "isotropic" : "as they are", seeds,
                                           std::sqrt(variance)),
                    .value = mean,
                    .reference = reference,
                    .tolerance = 0.08});
    };
    compare("four-point bending, 24 x 6 m, l = 1 m,", points, 1);
    const double poisson = isotropic ? 0.3 : 0.07;
    compare("a cantilever of 12 x 6 m, l = 1 m,", roots, 1 / (1 - poisson * poisson));
  }
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
    options.propagation = Propagation::strength;
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
