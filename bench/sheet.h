/// \file
/// What the benchmarks step: a meshed sheet of about as many bodies as are asked for, in the order
/// in which a run has them, with a smooth deformation and motion.
#pragma once

#include <benchmark/benchmark.h>

#include <cmath>

#include "floe/base/petsc.h"
#include "floe/lattice/lattice.h"
#include "floe/lattice/state.h"
#include "floe/session/session.h"
#include "lattice/partition.h"

namespace floe::bench {

inline Lattice meshed_sheet(std::int64_t bodies, const SheetSection& section = {}) {
  SheetPlan plan;
  plan.element_size = 1;
  plan.length = plan.width = std::sqrt(static_cast<double>(bodies) * std::sqrt(3.0) / 2);
  plan.iterations = 5;
  Lattice lattice = make_sheet(tessellate(plan, PETSC_COMM_SELF), section);
  (void)reorder(lattice);
  return lattice;
}

template <class Space>
void deform(const Part& part, State<Space>& state) {
  constexpr int turns = Space::unknowns - Space::translations;
  constexpr int first = Space::rotation + (turns == 3 ? 1 : 0);  // after a quaternion's w
  for (std::size_t b = 0; b < static_cast<std::size_t>(part.local); ++b) {
    const Point3& x = part.bodies.position[b];
    double* r = state.record(b);
    for (int k = 0; k < Space::translations; ++k) {
      r[k] = 1e-3 * std::sin(x[0] + k) * std::cos(x[1]);
      r[Space::velocity + k] = 1e-2 * std::sin(x[1] + k);
    }
    for (int k = 0; k < turns; ++k) r[first + k] = 1e-3 * std::cos(x[0] - k);
  }
}

/// The sheet on one process.
template <class Space>
struct Sheet {
  Part part;
  State<Space> state;
  Wrenches<Space> wrenches;
  explicit Sheet(std::int64_t bodies)
      : part(partition(meshed_sheet(bodies), PETSC_COMM_SELF)),
        state(static_cast<std::size_t>(part.local)),
        wrenches(static_cast<std::size_t>(part.local)) {
    deform(part, state);
  }
};

/// Runs a benchmark program's benchmarks in a session of PETSc.
inline int run(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  const Mpi mpi(argc, argv);
  const Session session(argv[0]);
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}

}  // namespace floe::bench
