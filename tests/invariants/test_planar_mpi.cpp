// Planar runs are the same on any number of ranks.
#include <gtest/gtest.h>

#include <cstring>

#include "floe/base/petsc.h"
#include "leapfrog/planar_leapfrog_stepper.h"
#include "support/dynamics.h"
#include "support/lattices.h"

namespace floe {
namespace {

Scene pulled() {
  Scene scene;
  scene.forces.beam = scene.forces.drag = true;
  scene.beam.damping_ratio = 0.5;
  scene.drag = {1e3, 1, 1010, {0.1, 0, 0}};
  Boundary left, right;
  left.name = left.set = "left", left.fixed[0] = left.fixed[5] = true;
  right.name = right.set = "right", right.fixed[0] = true;
  right.velocity = Point3{0.1, 0, 0}, right.ramp.seconds = 0.005;
  scene.boundaries = {left, right};
  Load load;
  load.name = "p", load.point = Point2{0.4, 0.7}, load.force = {1e5, -1e5, 0};
  scene.loads = {load};
  return scene;
}

Lattice sheet() {
  Lattice s = test::sheet(12, 9, 1);
  reorder(s);
  return s;
}

TEST(PlanarRanks, AThousandStepsAreTheSameBitForBit) {
  const Lattice lattice = sheet();
  test::DynamicsIn<Planar> together(pulled(), lattice, PETSC_COMM_WORLD), alone(pulled(), lattice);
  for (auto* run : {&together, &alone}) {
    run->set_step(2e-5);
    run->steps(1000);
  }
  EXPECT_GT(test::expect_same_bits(together, alone), 1e-5);
}

/// Displacements of all bodies at the end of a static run, and its number of unstable modes.
std::pair<std::vector<double>, std::int64_t> solve(const Scene& scene, const Lattice& lattice,
                                                   MPI_Comm comm) {
  const auto loads = place_loads(scene, lattice);
  Model<Planar> model(lattice, comm, scene.boundaries);
  add_forces(scene, loads, model);
  hold_free_motions(scene, lattice, model);
  const OutOfPlane rest = out_of_plane(scene, lattice, loads, model.part());
  std::vector<double> u(lattice.bodies.mass.size() * 3, 0);
  const RunResult result = run_quasistatic(
      model, {1, 0.5},
      [&](const Accepted<Planar>& a) {
        for (std::size_t b = 0; b < static_cast<std::size_t>(model.part().owned); ++b)
          std::copy_n(a.state.record(b), 3,
                      u.begin() + 3 * static_cast<std::ptrdiff_t>(model.part().global[b]));
      },
      &rest);
  EXPECT_TRUE(result.done) << result.message;
  MPI_Allreduce(MPI_IN_PLACE, u.data(), static_cast<int>(u.size()), MPI_DOUBLE, MPI_SUM, comm);
  return {u, result.unstable_modes};
}

TEST(PlanarRanks, StaticsAreTheSame) {
  const Lattice lattice = sheet();
  for (const auto& [force, linear] : {std::pair{1e5, false}, {1e5, true}, {-4e7, false}}) {
    Scene scene = pulled();
    scene.forces.drag = false;
    scene.beam.damping_ratio = 0;
    scene.beam.kinematics = linear ? Kinematics::linear : Kinematics::corotational;
    scene.boundaries.pop_back();
    scene.boundaries[0].fixed[1] = true;
    scene.loads[0].point.reset();
    scene.loads[0].set = "right", scene.loads[0].force = {force, 0.1 * force, 0};
    scene.loads[0].ramp.seconds = 1;
    const auto [together, modes] = solve(scene, lattice, PETSC_COMM_WORLD);
    const auto [alone, modes_alone] = solve(scene, lattice, PETSC_COMM_SELF);
    EXPECT_EQ(modes, modes_alone);
    EXPECT_EQ(modes > 0, force < 0);
    double largest = 0, difference = 0;
    for (std::size_t k = 0; k < alone.size(); ++k) {
      largest = std::max(largest, std::abs(alone[k]));
      difference = std::max(difference, std::abs(together[k] - alone[k]));
    }
    EXPECT_LE(difference, 1e-10 * largest);
    EXPECT_GT(largest, 1e-5);
  }
}

}  // namespace
}  // namespace floe
