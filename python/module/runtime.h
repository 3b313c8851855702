/// \file
/// MPI, PETSc and the simulations of a Python process.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "floe/session/solver_options.h"
#include "floe/simulation.h"

namespace floe::python {

/// Starts MPI, if nobody has, and PETSc, once. Collective.
void start();
/// Ends all simulations, PETSc, and MPI if it was started here. Collective; nothing works after it.
void finish();

/// A simulation and the options of PETSc that it needs.
struct Held {
  std::shared_ptr<SolverOptions> options;
  std::unique_ptr<Simulation> simulation;
};

/// A simulation as Python holds it. The collector, which is not the same on all ranks, only marks
/// it: free_dropped() destroys it once all ranks have dropped it.
class Owner {
 public:
  /// To be made on all ranks in the same order.
  explicit Owner(Held held);
  ~Owner();
  Owner(const Owner&) = delete;
  Owner& operator=(const Owner&) = delete;

  /// Null after free().
  Held* get();
  /// Destroys the simulation. Collective.
  void free();

 private:
  std::int64_t number_;
};

/// Destroys what all ranks have dropped. Collective.
void free_dropped();
/// Number of simulations that are not destroyed.
std::size_t alive();

}  // namespace floe::python
