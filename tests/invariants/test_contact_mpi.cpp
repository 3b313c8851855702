// Contacts do not depend on the number of ranks, and go on over a restart to the last bit.

#include <gtest/gtest.h>

#include <cstdio>
#include <optional>

#include "contact_force/contact.h"
#include "contact_laws/restitution.h"
#include "files/hdf5.h"
#include "support/blocks.h"
#include "support/dynamics.h"

namespace floe {
namespace {

/// Stones that fall on a floor, on each other and on a pier that goes, turns and swings.
struct Heap {
  Lattice lattice;
  Scene scene;
  Heap() {
    scene.integrator = Integrator::explicit_;
    scene.forces.contact = scene.forces.gravity = true;
    scene.contact.young = 1e7;
    scene.contact.friction = 0.3;
    scene.contact.plastic_limit.pressure = 1e5;
    scene.contact.initial_overlap = InitialOverlap::stress_free;  // of a stone and the pier
    scene.contact.damping_ratio = damping_ratio_of(0.4);
    scene.obstacles = {half_space({0, 0, 0}, {0, 0, 1}), box({4, 4, 0}, {2, 2, 3}, {10, 20, 30})};
    scene.obstacles[0].name = "floor";
    scene.obstacles[1].name = "pier";
    scene.obstacles[1].motion = {.velocity = {-0.5, 0, 0},
                                 .angular_velocity = {0.3, -0.5, 1.5},
                                 .amplitude = {0, 0.05, 0.02},
                                 .frequency = 3,
                                 .ramp = {0.2}};
    test::Random random(11);
    for (int k = 0; k < 48; ++k)
      test::append_stone(lattice, random, {1.7 * (k % 4), 1.7 * (k / 4 % 4), 1.2 + 1.7 * (k / 16)},
                         random.rotation(random.uniform(0, 3)), random.vector(0.5),
                         random.vector(0.5));
  }
};

constexpr double dt = 2e-4;

/// Records of all bodies in global order, on all ranks.
std::vector<double> all_records(test::Dynamics& d) {
  const Part& part = d.model().part();
  std::vector<double> mine(static_cast<std::size_t>(part.global_bodies) * Spatial::record, 0.0);
  for (std::int32_t b = 0; b < part.owned; ++b)
    std::copy_n(d.state().record(static_cast<std::size_t>(b)), Spatial::record,
                &mine[static_cast<std::size_t>(part.global[static_cast<std::size_t>(b)]) *
                      Spatial::record]);
  std::vector<double> all(mine.size());
  MPI_Allreduce(mine.data(), all.data(), static_cast<int>(mine.size()), MPI_DOUBLE, MPI_SUM,
                part.comm);
  return all;
}

TEST(ContactOnRanks, BodiesMoveTheSame) {
  const Heap heap;
  test::Dynamics alone(heap.scene, heap.lattice),
      shared(heap.scene, heap.lattice, PETSC_COMM_WORLD);
  for (auto* d : {&alone, &shared}) {
    d->set_step(dt);
    d->steps(4000);
  }
  EXPECT_GT(alone.reported("contacts"), 60);
  EXPECT_EQ(alone.reported("contacts"), shared.reported("contacts"));
  EXPECT_GT(alone.reported("energy_crushing"), 0);
  const std::vector<double> a = all_records(alone), b = all_records(shared);
  for (std::size_t k = 0; k < a.size(); ++k) ASSERT_EQ(a[k], b[k]) << k;
  for (const char* name : {"energy_contact", "energy_contact_viscous", "energy_friction",
                           "energy_crushing", "energy_external", "floor_force_z", "pier_moment_y",
                           "pier_peak_force_x", "floor_mean_force_z"})
    EXPECT_NEAR(alone.reported(name), shared.reported(name), 1e-10 * std::abs(alone.reported(name)))
        << name;
}

TEST(ContactOnRanks, RestartGoesOnToTheLastBit) {
  const Heap heap;
  const std::string file = "contact_memory_" + std::to_string(size(PETSC_COMM_WORLD)) + ".h5";
  test::Dynamics through(heap.scene, heap.lattice, PETSC_COMM_WORLD),
      resumed(heap.scene, heap.lattice, PETSC_COMM_WORLD);
  const Part& part = through.model().part();
  const auto contact = [](test::Dynamics& d) -> Persists& {
    return *d.model().forces().back()->roles().persists;
  };
  through.set_step(dt);
  through.steps(3600);
  // As a run does it: after a step, before the next evaluation.
  (void)through.step_without_evaluation();
  {
    std::optional<Hdf5File> out;
    if (rank(PETSC_COMM_WORLD) == 0) out.emplace(Hdf5File::create(file));
    Archive memory(part, out ? &*out : nullptr, Transfer::save);
    through.persist(memory);
    memory.enter("contact");
    contact(through).persist(memory);
    if (out) out->close();
  }
  MPI_Barrier(PETSC_COMM_WORLD);
  {
    std::optional<Hdf5File> in;
    if (rank(PETSC_COMM_WORLD) == 0) in.emplace(Hdf5File::open(file));
    if (in) {  // stones have crushed and lost corners
      EXPECT_GT(in->read("contact/worn").size(), 8U);
      EXPECT_GT(in->read("contact/crushed").size(), 10U);
    }
    Archive memory(part, in ? &*in : nullptr, Transfer::load);
    resumed.persist(memory);
    memory.enter("contact");
    contact(resumed).persist(memory);
  }
  resumed.state() = through.state();
  for (auto* d : {&through, &resumed}) {
    d->evaluate();
    if (d == &resumed) d->go_on(dt);
    d->steps(500);
  }
  const std::vector<double> a = all_records(through), b = all_records(resumed);
  for (std::size_t k = 0; k < a.size(); ++k) ASSERT_EQ(a[k], b[k]) << k;
  for (const char* name :
       {"energy_contact", "energy_contact_viscous", "energy_friction", "energy_crushing",
        "energy_external", "pier_peak_force_x", "floor_mean_force_z"})
    EXPECT_EQ(through.reported(name), resumed.reported(name)) << name;
  MPI_Barrier(PETSC_COMM_WORLD);
  if (rank(PETSC_COMM_WORLD) == 0) std::remove(file.c_str());
}

}  // namespace
}  // namespace floe
