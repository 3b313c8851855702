// Waves, drag on faces with its shelter, and added mass by direction do not depend on the number of
// ranks, and go on over a restart to the last bit.

#include <gtest/gtest.h>

#include <cstdio>
#include <optional>

#include "files/hdf5.h"
#include "support/dynamics.h"
#include "support/lattices.h"

namespace floe {
namespace {

/// A sheet that breaks in a wave; its bodies drift apart.
struct Sea {
  Lattice lattice = test::sheet(7, 5, 1.2, true);
  Scene scene;
  explicit Sea(int pace) {
    scene.water_pace = pace;
    for (double& young : lattice.beams.young) young = 1e7;
    for (double& shear : lattice.beams.shear_modulus) shear = 4e6;
    test::Random random(7);
    for (std::size_t b = 0; b < lattice.bodies.mass.size(); ++b) {
      lattice.bodies.velocity.push_back(random.vector(0.6));
      lattice.bodies.angular_velocity.push_back(random.vector(0.3));
    }
    scene.integrator = Integrator::explicit_;
    scene.forces.beam = scene.forces.fracture = scene.forces.gravity = scene.forces.buoyancy =
        scene.forces.drag = true;
    scene.fracture.tensile_strength = scene.fracture.shear_strength = 2e4;
    scene.drag = {.linear = 20, .current = {0.2, 0, 0}};
    scene.drag.faces = true;
    scene.drag.form = 1.1, scene.drag.skin = 0.004, scene.drag.shelter = 0.1;
    scene.added_mass_plate = true;
    scene.waves = {.spectrum = WaveOptions::Spectrum::jonswap, .height = 0.3, .period = 9};
    scene.waves.direction = 0.4, scene.waves.ramp = 0.1;
  }
};

constexpr double dt = 2e-4;

void expect_same(test::Dynamics& a, test::Dynamics& b) {
  ASSERT_EQ(a.state().records.size(), b.state().records.size());
  for (std::int32_t body = 0; body < a.model().part().owned; ++body) {
    const auto k = static_cast<std::size_t>(body);
    for (std::size_t n = 0; n < Spatial::record; ++n)
      ASSERT_EQ(a.state().record(k)[n], b.state().record(k)[n]) << body << " " << n;
  }
}

void expect_same_on_ranks(const Sea& sea) {
  test::Dynamics together(sea.scene, sea.lattice, PETSC_COMM_WORLD), alone(sea.scene, sea.lattice);
  for (auto* run : {&together, &alone}) {
    run->set_step(dt);
    run->steps(3000);
  }
  EXPECT_GT(alone.reported("beams_broken"), 20);  // by the bodies' velocities
  EXPECT_GT(test::expect_same_bits(together, alone), 0.1);
  for (const char* name : {"energy_drag", "energy_external"}) {
    EXPECT_EQ(alone.reported(name) != 0, name[7] == 'd' || sea.scene.waves.any()) << name;
    EXPECT_NEAR(alone.reported(name), together.reported(name),
                1e-10 * std::abs(alone.reported(name)));
  }
}

TEST(WaterOnRanks, BodiesMoveTheSame) { expect_same_on_ranks(Sea(1)); }
TEST(WaterOnRanks, BodiesMoveTheSameAtAPace) {
  Sea sea(10);
  expect_same_on_ranks(sea);
  sea.scene.waves = {};  // still water, where bodies are in lanes
  expect_same_on_ranks(sea);
}

/// The checkpoint lies between two steps that compute the water, if it has a pace.
void expect_same_after_restart(const Sea& sea) {
  const std::string file = "water_memory_" + std::to_string(size(PETSC_COMM_WORLD)) + ".h5";
  test::Dynamics through(sea.scene, sea.lattice, PETSC_COMM_WORLD),
      resumed(sea.scene, sea.lattice, PETSC_COMM_WORLD);
  const auto visit = [&](test::Dynamics& run, Archive& archive) {
    run.persist(archive);
    for (std::size_t k = 0; k < run.model().forces().size(); ++k) {
      archive.enter("force_" + std::to_string(k));
      if (auto* role = run.model().forces()[k]->roles().persists) role->persist(archive);
    }
  };
  through.set_step(dt);
  through.steps(1500);
  (void)through.step_without_evaluation();  // as a run does it
  {
    std::optional<Hdf5File> out;
    if (rank(PETSC_COMM_WORLD) == 0) out.emplace(Hdf5File::create(file));
    Archive archive(through.model().part(), out ? &*out : nullptr, Transfer::save);
    visit(through, archive);
    if (out) out->close();
  }
  MPI_Barrier(PETSC_COMM_WORLD);
  {
    std::optional<Hdf5File> in;
    if (rank(PETSC_COMM_WORLD) == 0) in.emplace(Hdf5File::open(file));
    Archive archive(resumed.model().part(), in ? &*in : nullptr, Transfer::load);
    visit(resumed, archive);
  }
  resumed.state() = through.state();
  resumed.go_on(dt);
  for (auto* run : {&through, &resumed}) {
    run->evaluate();
    run->steps(1500);
  }
  expect_same(through, resumed);
  for (const char* name : {"energy_drag", "energy_external", "beams_broken"})
    EXPECT_EQ(through.reported(name), resumed.reported(name)) << name;
  MPI_Barrier(PETSC_COMM_WORLD);
  if (rank(PETSC_COMM_WORLD) == 0) std::remove(file.c_str());
}

TEST(WaterOnRanks, RestartGoesOnToTheLastBit) { expect_same_after_restart(Sea(1)); }
TEST(WaterOnRanks, RestartGoesOnToTheLastBitAtAPace) {
  Sea sea(10);
  expect_same_after_restart(sea);
  sea.scene.waves = {};
  expect_same_after_restart(sea);
  sea.scene.drag.faces = false;
  expect_same_after_restart(sea);
  sea.scene.drag.faces = true;
  sea.scene.forces.buoyancy = sea.scene.forces.gravity = false;  // drag leads
  expect_same_after_restart(sea);
}

}  // namespace
}  // namespace floe
