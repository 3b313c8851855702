// An explicit run is the same on any number of ranks, and a step takes no memory.
#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "floe/base/petsc.h"
#include "support/dynamics.h"
#include "support/lattices.h"

#if !defined(__SANITIZE_ADDRESS__)
#define FLOE_COUNT_ALLOCATIONS 1
namespace {
std::atomic<long> allocations{0};
}
// glibc's own names of what they replace here; PETSc's and MPI's calls come through them too.
extern "C" {
// NOLINTBEGIN(readability-identifier-naming)
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
// NOLINTEND(readability-identifier-naming)
void* malloc(std::size_t size) {
  ++allocations;
  return __libc_malloc(size);
}
void* calloc(std::size_t n, std::size_t size) {
  ++allocations;
  return __libc_calloc(n, size);
}
void* realloc(void* p, std::size_t size) {
  ++allocations;
  return __libc_realloc(p, size);
}
}
#endif

namespace floe {
namespace {

/// Pulled on one side, pushed down at a point, damped, on water.
Scene pulled() {
  Scene scene;
  scene.forces.beam = scene.forces.gravity = scene.forces.buoyancy = true;
  scene.beam.damping_ratio = 0.5;
  Boundary left, right;
  left.name = left.set = "left", left.fixed[0] = left.fixed[4] = true;
  right.name = right.set = "right", right.fixed[0] = true;
  right.velocity = Point3{0.1, 0, 0}, right.ramp.seconds = 0.005;
  scene.boundaries = {left, right};
  Load load;
  load.name = "p", load.point = Point2{0.4, 0.7}, load.force = {0, 0, -1e5};
  scene.loads = {load};
  return scene;
}

Lattice floating_sheet() {
  Lattice s = test::sheet(12, 9, 1, true);
  reorder(s);
  return s;
}

TEST(ExplicitRanks, AThousandStepsAreTheSameBitForBit) {
  const Lattice lattice = floating_sheet();
  test::Dynamics together(pulled(), lattice, PETSC_COMM_WORLD), alone(pulled(), lattice);
  for (test::Dynamics* run : {&together, &alone}) {
    run->set_step(2e-5);
    run->steps(1000);
  }
  EXPECT_GT(test::expect_same_bits(together, alone), 1e-5);
}

/// By run_explicit, with a step of its own choice: the stable step is a sum over ranks, so it may
/// differ in its last digits.
TEST(ExplicitRanks, ARunWithItsOwnStepIsTheSameTo1e9) {
  const Lattice lattice = floating_sheet();
  const auto run = [&](MPI_Comm comm) {
    const Scene scene = pulled();
    Model<Spatial> model(lattice, comm, scene.boundaries);
    add_forces(scene, place_loads(scene, lattice), model);
    ExplicitOptions options;
    options.end = 0.01;
    std::vector<double> u(lattice.bodies.mass.size() * 3, 0);
    const RunResult result = run_explicit(model, options, [&](const Accepted<Spatial>& a) {
      for (std::size_t b = 0; b < static_cast<std::size_t>(model.part().owned); ++b)
        std::copy_n(a.state.record(b), 3,
                    u.begin() + 3 * static_cast<std::ptrdiff_t>(model.part().global[b]));
    });
    EXPECT_TRUE(result.done) << result.message;
    MPI_Allreduce(MPI_IN_PLACE, u.data(), static_cast<int>(u.size()), MPI_DOUBLE, MPI_SUM, comm);
    return u;
  };
  const std::vector<double> together = run(PETSC_COMM_WORLD), alone = run(PETSC_COMM_SELF);
  double largest = 0, difference = 0;
  for (std::size_t k = 0; k < alone.size(); ++k) {
    largest = std::max(largest, std::abs(alone[k]));
    difference = std::max(difference, std::abs(together[k] - alone[k]));
  }
  EXPECT_LE(difference, 1e-9 * largest);
}

#ifdef FLOE_COUNT_ALLOCATIONS
TEST(ExplicitMemory, AStepTakesNone) {
  test::Dynamics run(pulled(), floating_sheet(), PETSC_COMM_WORLD);
  run.set_step(2e-5);
  run.steps(10);  // what MPI and logging set up at first
  const long before = allocations;
  run.steps(500);
  // One rank steps alone; MPI's own receive queues on several ranks are its affair.
  const long taken = allocations - before;
  if (size() == 1) {
    EXPECT_EQ(taken, 0);
  } else {
    RecordProperty("allocations", static_cast<int>(taken));
  }
}
#endif

}  // namespace
}  // namespace floe
