/// \file
/// Integrators take a model from its first state to the scene's end and hand every accepted state
/// to an observer.
#pragma once

#include <functional>
#include <string>

#include "floe/solve/model.h"

namespace floe {

/// An accepted state, with what is known of the step that led to it.
template <class Space>
struct Accepted {
  const State<Space>& state;
  const Wrenches<Space>& wrenches;  ///< of all forces, on owned bodies
  std::int64_t step;                ///< 0: the initial state
};

/// How a run ended, for summary.json and the exit code.
struct RunResult {
  bool done = false;
  std::string message;
  std::int64_t steps = 0;
  std::int64_t newton_iterations = 0;
  double dt = 0;                     ///< last step taken
  std::int64_t unstable_modes = -1;  ///< of the last equilibrium; -1: not known
};

struct TimeSpan {
  double end = 1;
  double dt = 0;  ///< 0: one step
};

template <class Space>
using Observer = std::function<void(const Accepted<Space>&)>;

/// Equilibrium at pseudo-time 0 and after each load step up to the end: SNES Newton with the exact
/// tangent, the step halved when Newton fails. All of PETSc's -snes_*, -ksp_*, -pc_*, -mat_*
/// options apply; the default is Newton with preonly + Cholesky by MUMPS on blocked symmetric
/// storage. Collective.
RunResult run_quasistatic(Model<Spatial>& model, const TimeSpan& time,
                          const Observer<Spatial>& observer);

/// Sets the static solver up and gives it up again: for -check. \throws InputError for a solver
/// PETSc does not have
void check_solver_options(Model<Spatial>& model);

}  // namespace floe
