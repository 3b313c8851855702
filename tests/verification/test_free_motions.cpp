// A static answer must not depend on how free rigid motions are taken out, nor on the linear
// solver, and small strains must give the linear answer (model.md, "Static solution").
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <random>
#include <set>

#include "support/record.h"
#include "support/tension.h"

namespace floe::test {
namespace {

constexpr const char* section_name = "Tension: the same answer however it is found";
constexpr double length = 20, thickness = 1, element_size = 2;  // 116 bodies

Scene scene_with(double strain, Shear shear = Shear::one_point) {
  Scene scene = tension_scene(length, thickness, element_size, 1, strain);
  scene.beam.shear = shear;
  return scene;
}

double solved_young(const Scene& scene, const Lattice& lattice) {
  const StaticSolution s = solve_static(scene, lattice);
  EXPECT_TRUE(s.result.done) << s.result.message;
  return young_ratio(scene, lattice, s);
}

TEST(FreeMotions, YoungsModulusDoesNotDependOnThePins) {
  for (const Shear shear : all_shears) {
    const Scene scene = scene_with(1e-3, shear);
    const Lattice lattice = mesh_of(scene);
    const double young = solved_young(scene, lattice);
    const std::vector<std::uint8_t> prescribed = prescribed_components(lattice, scene.boundaries);
    std::mt19937 engine(7);
    double largest = 0;
    std::set<std::pair<std::int32_t, int>> pinned;
    constexpr int choices = 12;
    for (int k = 0; k < choices; ++k) {
      // Half of the bodies, then all but a few neighbours: pins far from each other and close
      // together.
      std::vector<std::uint8_t> avoid(prescribed.size(), 1);
      for (std::uint8_t& a : avoid) a = k % 2 == 0 ? engine() % 2 : 1;
      if (k % 2 == 1) {
        const auto& [i, j] = lattice.beams.bodies[engine() % lattice.beams.bodies.size()];
        avoid[static_cast<std::size_t>(i)] = avoid[static_cast<std::size_t>(j)] = 0;
      }
      const FreeMotions free = free_motions(lattice, prescribed, {}, avoid);
      // y, z, rotation about x and, of the flat unstressed sheet, about y
      EXPECT_EQ(free.motions.size(), 4U);
      EXPECT_EQ(free.pins.size(), free.motions.size());
      for (const Pin& pin : free.pins) pinned.insert({pin.body, pin.component});
      const StaticSolution s = solve_static(scene, lattice, &free.pins);
      largest = std::max(largest, std::abs(young_ratio(scene, lattice, s) / young - 1));
    }
    EXPECT_GE(pinned.size(), 12U) << "the choices are all alike";
    verify({.section = section_name,
            .quantity = "E with other pins, " + name_of(shear) + ": largest relative difference",
            .value = largest,
            .reference = 0.0,
            .tolerance = 1e-10,
            .note = std::to_string(choices) + " random choices, " + std::to_string(pinned.size()) +
                    " different unknowns pinned"});
  }
}

/// Nothing prescribed at all: three vertical and two horizontal loads in balance bend and stretch
/// the sheet.
TEST(FreeMotions, EnergyOfAFreeSheetInBalanceDoesNotDependOnThePins) {
  Scene scene = scene_with(0);
  const Lattice lattice = mesh_of(scene);
  scene.boundaries.clear();
  const double f = 1e-2;  // small: turned loads would be out of balance
  for (const auto& [x, force] :
       {std::pair{-8.0, Point3{-f, 0, f / 2}}, std::pair{0.0, Point3{0, 0, -f}},
        std::pair{8.0, Point3{f, 0, f / 2}}}) {
    Load load;
    load.name = "at " + std::to_string(x);
    load.point = Point2{x, 1.0};
    load.force = force;
    load.ramp.seconds = 1;
    scene.loads.push_back(load);
  }
  const auto energy = [](const StaticSolution& s) { return s.columns.at("energy_strain"); };
  const double reference = energy(solve_static(scene, lattice));
  ASSERT_GT(reference, 0);
  const std::vector<std::uint8_t> nothing(lattice.bodies.position.size(), 0);
  std::mt19937 engine(11);
  double largest = 0;
  constexpr int choices = 12;
  for (int k = 0; k < choices; ++k) {
    std::vector<std::uint8_t> avoid(nothing.size(), 0);
    for (std::uint8_t& a : avoid) a = engine() % 8 != 0;
    const FreeMotions free = free_motions(lattice, nothing, {}, avoid);
    EXPECT_EQ(free.pins.size(), 6U);
    largest = std::max(largest,
                       std::abs(energy(solve_static(scene, lattice, &free.pins)) / reference - 1));
  }
  verify({.section = section_name,
          .quantity =
              "strain energy of a free sheet under balanced loads: largest relative difference",
          .value = largest,
          .reference = 0.0,
          .tolerance = 1e-8,
          .note = std::to_string(choices) + " random choices of the six unknowns pinned"});
}

TEST(FreeMotions, YoungsModulusDoesNotDependOnTheLinearSolver) {
  struct Solver {
    const char* name;
    std::vector<std::pair<const char*, const char*>> options;
  };
  const Scene scene = scene_with(1e-3);
  const Lattice lattice = mesh_of(scene);
  const double young = solved_young(scene, lattice);
  for (const Solver& solver :
       {Solver{"LU", {{"-pc_type", "lu"}}},
        Solver{"LU by PETSc", {{"-pc_type", "lu"}, {"-pc_factor_mat_solver_type", "petsc"}}},
        Solver{"CG + GAMG", {{"-ksp_type", "cg"}, {"-pc_type", "gamg"}}}}) {
    std::vector<std::unique_ptr<PetscOption>> set;
    for (const auto& [name, value] : solver.options)
      set.push_back(std::make_unique<PetscOption>(name, value));
    verify({.section = section_name,
            .quantity = std::string("E by ") + solver.name + ": relative difference to Cholesky's",
            .value = solved_young(scene, lattice) / young - 1,
            .reference = 0.0,
            .tolerance = 1e-9});
  }
}

TEST(FreeMotions, SmallStrainsGiveTheLinearAnswer) {
  for (const Shear shear : all_shears) {
    Scene linear = scene_with(1e-3, shear);
    linear.beam.kinematics = Kinematics::linear;
    const Lattice lattice = mesh_of(linear);
    const double young = solved_young(linear, lattice);
    const auto compare = [&](double strain, double tolerance) {
      char name[80];
      std::snprintf(name, sizeof name, "E at strain %g, %s: relative difference to the linear",
                    strain, name_of(shear).c_str());
      verify({.section = section_name,
              .quantity = name,
              .value = solved_young(scene_with(strain, shear), lattice) / young - 1,
              .reference = 0.0,
              .tolerance = tolerance});
    };
    compare(1e-3, 1e-3);
    compare(1e-9, 1e-6);
    compare(1e-12, 1e-3);
  }
}

}  // namespace
}  // namespace floe::test
