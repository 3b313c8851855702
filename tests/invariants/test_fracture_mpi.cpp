// A sheet breaks in the same way on any number of ranks: the same beams, in the same order, to the
// last bit.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <vector>

#include "floe/base/petsc.h"
#include "support/dynamics.h"
#include "support/lattices.h"

namespace floe {
namespace {

Scene torn(bool dynamic) {
  Scene scene;
  scene.forces.beam = scene.forces.fracture = true;
  if (dynamic) scene.beam.damping_ratio = 0.2;
  scene.fracture.weibull_modulus = 6;
  scene.fracture.energy = dynamic ? 30 : 5;
  scene.fracture.energy_shear = dynamic ? 60 : 10;
  scene.fracture.dynamic = dynamic;
  for (const char* side : {"left", "right"}) {
    Boundary b;
    b.name = b.set = side;
    b.fixed = {true, true, true, false, false, false};
    b.displacement = Point3{std::string(side) == "left" ? 0 : 0.006, 0, 0};
    b.ramp.seconds = dynamic ? 0.02 : 1;
    scene.boundaries.push_back(b);
  }
  return scene;
}

Lattice small_elements() {
  Lattice s = test::sheet(4, 3, 0.25);
  reorder(s);
  return s;
}

/// This rank's breaks and all others', in the order of (time, beam).
std::vector<Break> all_breaks(const Model<Spatial>& model) {
  std::vector<double> mine, all;
  for (const Break& b : model.fracture()->breaks())
    mine.insert(mine.end(), {b.time, static_cast<double>(b.beam), b.mode_mix, b.energy, b.place[0],
                             b.at_tip ? 1.0 : 0.0});
  const Part& part = model.part();
  const int count = static_cast<int>(mine.size());
  const auto ranks = static_cast<std::size_t>(size(part.comm));
  std::vector<int> counts(ranks, 0), offsets(ranks, 0);
  MPI_Allgather(&count, 1, MPI_INT, counts.data(), 1, MPI_INT, part.comm);
  for (std::size_t r = 1; r < ranks; ++r) offsets[r] = offsets[r - 1] + counts[r - 1];
  all.resize(static_cast<std::size_t>(offsets.back() + counts.back()));
  MPI_Allgatherv(mine.data(), count, MPI_DOUBLE, all.data(), counts.data(), offsets.data(),
                 MPI_DOUBLE, part.comm);
  std::vector<Break> breaks;
  for (std::size_t k = 0; k < all.size(); k += 6)
    breaks.push_back({all[k],
                      static_cast<std::int32_t>(all[k + 1]),
                      {all[k + 4], 0, 0},
                      all[k + 2],
                      all[k + 3],
                      0,
                      false,
                      all[k + 5] != 0,
                      0});
  std::sort(breaks.begin(), breaks.end(), [](const Break& a, const Break& b) {
    return a.time != b.time ? a.time < b.time : a.beam < b.beam;
  });
  return breaks;
}

void breaks_alike(const Scene& scene, const Lattice& lattice) {
  test::Dynamics together(scene, lattice, PETSC_COMM_WORLD), alone(scene, lattice);
  for (test::Dynamics* run : {&together, &alone}) {
    run->set_step(1e-5);
    run->steps(2500);
  }
  const std::vector<Break> here = all_breaks(together.model()), there = all_breaks(alone.model());
  EXPECT_GT(there.size(), 10);
  const auto at_tips =
      std::count_if(there.begin(), there.end(), [](const Break& b) { return b.at_tip; });
  if (scene.fracture.propagation == Propagation::energy) {
    EXPECT_GT(at_tips, 10);
  } else {
    EXPECT_EQ(at_tips, 0);
  }
  ASSERT_EQ(here.size(), there.size());
  for (std::size_t k = 0; k < here.size(); ++k) {
    EXPECT_EQ(here[k].beam, there[k].beam);
    EXPECT_EQ(here[k].time, there[k].time);
    EXPECT_EQ(here[k].at_tip, there[k].at_tip);
    EXPECT_EQ(here[k].mode_mix, there[k].mode_mix);
    EXPECT_EQ(here[k].energy, there[k].energy);
    EXPECT_EQ(here[k].place[0], there[k].place[0]);
  }
  const Part &part = together.model().part(), &whole = alone.model().part();
  for (std::int32_t b = 0; b < part.owned; ++b) {
    const std::int32_t g = whole.local_index(part.global[static_cast<std::size_t>(b)]);
    EXPECT_EQ(std::memcmp(together.state().record(static_cast<std::size_t>(b)),
                          alone.state().record(static_cast<std::size_t>(g)),
                          Spatial::record * sizeof(double)),
              0);
  }
  // Partly damaged beams too, wherever they are seen.
  for (std::size_t m = 0; m < part.beams.bodies.size(); ++m)
    EXPECT_EQ(together.model().fracture()->damage(static_cast<std::int32_t>(m)),
              alone.model().fracture()->damage(part.global_beam[m]));
}

TEST(FractureRanks, ASheetBreaksInTheSameWayBitForBit) {
  breaks_alike(torn(true), small_elements());
}

/// Tips of cracks are the same, wherever the ranks' parts meet.
TEST(FractureRanks, CracksThatRunByEnergyAreTheSameBitForBit) {
  Scene scene = torn(true);
  scene.fracture.propagation = Propagation::energy;
  scene.fracture.energy = scene.fracture.energy_shear = 5;
  Lattice lattice = test::sheet(4, 3, 0.25);
  cut(lattice, {0, -2}, {0, -1});
  reorder(lattice);
  breaks_alike(scene, lattice);
}

/// In statics the order is that of the breaks; rounding of the solver differs.
TEST(FractureRanks, StaticsBreaksTheSameBeams) {
  const Lattice lattice = test::sheet(8, 6, 1);
  for (const Propagation propagation : {Propagation::strength, Propagation::energy}) {
    std::vector<std::vector<Break>> logs;
    for (const MPI_Comm comm : {PETSC_COMM_WORLD, PETSC_COMM_SELF}) {
      Scene scene = torn(false);
      scene.fracture.propagation = propagation;
      Model<Spatial> model(lattice, comm, scene.boundaries);
      add_forces(scene, {}, model, &lattice);
      hold_free_motions(scene, lattice, model);
      (void)run_quasistatic(model, {1, 0.05}, [](const Accepted<Spatial>&) {});
      logs.push_back(all_breaks(model));
    }
    EXPECT_GT(logs[1].size(), 3);
    ASSERT_EQ(logs[0].size(), logs[1].size());
    for (std::size_t k = 0; k < logs[0].size(); ++k) {
      EXPECT_EQ(logs[0][k].beam, logs[1][k].beam);
      EXPECT_EQ(logs[0][k].time, logs[1][k].time);
      EXPECT_NEAR(logs[0][k].energy, logs[1][k].energy, 1e-6 * logs[1][k].energy);
    }
  }
}

}  // namespace
}  // namespace floe
