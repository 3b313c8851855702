// The field's test of flexural strength: a cantilever that three cuts free from a floating sheet.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "support/record.h"
#include "support/static_solution.h"

namespace floe {
namespace {

constexpr double sigma_t = 6e5, h = 0.5, length = 5, width = 2;
constexpr double to_stress = 6 / (width * h * h);  ///< of a root moment

Scene sheet_of(double x, double y, double element, std::uint64_t seed) {
  Scene scene;
  scene.has_sheet = true;
  scene.sheet.length = x, scene.sheet.width = y;
  scene.sheet.element_size = element, scene.sheet.seed = seed;
  scene.thickness = h;
  scene.forces.beam = true;
  scene.beam.kinematics = Kinematics::linear;
  scene.integrator = Integrator::quasistatic;
  return scene;
}

/// Largest criterion s of a beam in the solution's last state.
double overload(const Scene& scene, const test::StaticSolution& s) {
  FractureOptions options;
  options.tensile_strength = options.shear_strength = sigma_t;
  return make_breakable_beams(s.model->part(), scene.beam, options).fracture->overload(s.last());
}

/// The scene of input/in_situ_cantilever.yaml, elastic: the tip is pushed down by a little.
Scene cantilever(double element, std::uint64_t seed) {
  Scene scene = sheet_of(24, 16, element, seed);
  scene.forces.gravity = scene.forces.buoyancy = true;
  scene.cuts = {{.name = "above", .from = {-2.5, 1}, .to = {2.5, 1}},
                {.name = "below", .from = {-2.5, -1}, .to = {2.5, -1}},
                {.name = "front", .from = {2.5, -1}, .to = {2.5, 1}}};
  scene.regions = {{"tip", {2, 2.5, -1, 1, -1, 1}}, {"beam", {-2.5, 2.5, -1, 1, -1, 1}}};
  Boundary hold, press;
  hold.name = "hold", hold.set = "left";
  hold.fixed = {true, true, false, false, false, true};
  press.name = "press", press.set = "tip";
  press.fixed = {true, true, true, false, false, true};
  press.displacement = Point3{0, 0, -1e-3};
  scene.boundaries = {hold, press};
  return scene;
}

/// Stress over sigma_t at the first break.
struct Strengths {
  double nominal;  ///< 6 F L/(w h^2)
  double of_root;  ///< 6 M/(w h^2), M the moment of the tip's forces and of the water at the root
};
Strengths strengths(const Scene& scene) {
  const Lattice lattice = test::mesh_of(scene);
  const test::StaticSolution s = test::solve_static(scene, lattice);
  double force = 0, moment = 0;
  for (const std::int32_t body : s.model->boundaries()[1].bodies) {
    const double f = -s.wrenches.of(static_cast<std::size_t>(body))[2];
    force += f;
    moment += f * (lattice.bodies.position[static_cast<std::size_t>(body)].x + length / 2);
  }
  for (const std::int32_t body : lattice.sets.at("beam")) {
    const auto b = static_cast<std::size_t>(body);
    const double area = lattice.bodies.mass[b] / (scene.ice.density * h);
    const double up = -scene.water_density * scene.gravity * area * displacement(s.last(), b).z;
    moment += up * (lattice.bodies.position[b].x + length / 2);
  }
  const double scale = to_stress / (sigma_t * overload(scene, s));
  return {std::abs(force) * length * scale, std::abs(moment) * scale};
}

/// Stress over sigma_t at the first break of a strip of the cantilever's size that moments on its
/// ends bend.
double of_strip(double element, std::uint64_t seed) {
  Scene scene = sheet_of(length, width, element, seed);
  for (const char* side : {"left", "right"}) {
    Load load;
    load.name = load.set = side;
    load.moment = {0, std::string(side) == "left" ? 1e3 : -1e3, 0};
    scene.loads.push_back(load);
  }
  const test::StaticSolution s = test::solve_static(scene, test::mesh_of(scene));
  return 1e3 * to_stress / (sigma_t * overload(scene, s));
}

TEST(Cantilever, Study) {
  for (const double element : {2.0, 1.0, 0.5}) {
    std::vector<double> a, b, c, d;
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
      Scene scene = cantilever(element, seed);
      if (element > 0.7) for (Region& r : scene.regions) if (r.name == "tip") r.box[0] = 2.5 - element;
      const Strengths n = strengths(scene);
      scene.fit_cuts = false;
      const Strengths o = strengths(scene);
      a.push_back(n.nominal), b.push_back(n.of_root), c.push_back(of_strip(element, seed));
      d.push_back(o.nominal);
    }
    for (const auto& v : {a, b, c, d}) {
      double mean = 0, sd = 0;
      for (double x : v) mean += x / 10;
      for (double x : v) sd += (x - mean) * (x - mean) / 9;
      std::printf("l %g  %.4f +- %.4f (", element, mean, std::sqrt(sd));
      for (double x : v) std::printf(" %.3f", x);
      std::printf(")\n");
    }
  }
}

}  // namespace
}  // namespace floe
