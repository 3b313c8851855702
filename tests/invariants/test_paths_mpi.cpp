// A path with breaks is the same on any number of ranks: load factors, order of breaks, energies.
#include <gtest/gtest.h>

#include "floe/base/petsc.h"
#include "support/lattices.h"
#include "support/paths.h"

namespace floe::test {
namespace {

TEST(PathOnRanks, LeesFrame) {
  PathOptions<Planar> options;
  options.arc = options.arc_max = 0.05;
  options.load_factor = 20;
  const auto alone = follow<Planar>(lee_scene(), lee_frame(10), options);
  const auto all = follow<Planar>(lee_scene(), lee_frame(10), options, PETSC_COMM_WORLD);
  ASSERT_TRUE(alone.result.done && all.result.done) << all.result.message;
  ASSERT_EQ(alone.columns.size(), all.columns.size());
  for (const char* name : {"load_factor", "arc_length", "energy_strain", "energy_external"}) {
    const auto one = alone.column(name), many = all.column(name);
    for (std::size_t k = 0; k < one.size(); ++k)
      EXPECT_NEAR(one[k], many[k], 1e-6 * (1 + std::abs(one[k]))) << name << " " << k;
  }
  EXPECT_EQ(all.result.path->limit_points.size(), 2U);
}

TEST(PathOnRanks, SheetThatBreaksAndSoftens) {
  Scene scene;
  scene.forces.beam = scene.forces.fracture = true;
  scene.fracture.weibull_modulus = 6;
  scene.fracture.energy = scene.fracture.energy_shear =
      60;  // some beams soften, some break at once
  scene.fracture.dynamic = false;
  for (const char* side : {"left", "right"}) {
    Boundary b;
    b.name = b.set = side;
    b.fixed = {true, true, true, true, true, true};
    b.displacement = Point3{b.set == "left" ? 0 : 0.006, 0, 0};
    b.ramp.seconds = 1;
    scene.boundaries.push_back(b);
  }
  Lattice lattice = sheet(4, 3, 0.5);
  reorder(lattice);
  PathOptions<Spatial> options;
  options.load_factor = 1;
  options.steps = 60;
  options.growth = 0.3;
  const auto alone = follow<Spatial>(scene, lattice, options);
  const auto all = follow<Spatial>(scene, lattice, options, PETSC_COMM_WORLD);
  ASSERT_TRUE(alone.result.done && all.result.done) << all.result.message;
  ASSERT_EQ(alone.columns.size(), all.columns.size());
  EXPECT_GT(all.last("beams_broken"), 3);
  EXPECT_GT(all.last("beams_damaged"), all.last("beams_brittle"));
  for (const char* name : {"load_factor", "beams_damaged", "beams_broken", "energy_fracture",
                           "energy_released", "energy_boundary"}) {
    const auto one = alone.column(name), many = all.column(name);
    const double size = std::abs(*std::max_element(one.begin(), one.end()));
    for (std::size_t k = 0; k < one.size(); ++k)
      EXPECT_NEAR(one[k], many[k], 1e-5 * size) << name << " " << k;
  }
}

}  // namespace
}  // namespace floe::test
