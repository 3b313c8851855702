/// \file
/// Static equilibrium, load step by load step.
#pragma once

#include <memory>
#include <vector>

#include "run/integrator.h"

namespace floe {

struct TimeSpan {
  double end = 1;
  double dt = 0;  ///< 0: one step
  double most_steps = default_most_steps;
  OnPlan on_plan = nullptr;
};

/// What a planar model leaves out, for one question at the end of a static run: whether the
/// equilibrium would stand a disturbance out of plane.
struct OutOfPlane {
  std::vector<std::unique_ptr<Force<Spatial>>> forces;
  std::vector<std::uint8_t> held;  ///< per local body, bits of x y z rx ry rz: prescribed or pinned
};

/// Equilibrium at pseudo-time 0 and after each load step up to the end: SNES Newton with the exact
/// tangent, the step halved when Newton fails. All of PETSc's -snes_*, -ksp_*, -pc_*, -mat_*
/// options apply; the default is Newton with preonly + Cholesky by MUMPS on blocked symmetric
/// storage. Collective. \param rest  of a planar model: its unstable modes count too; else null
template <class Space>
RunResult run_quasistatic(Model<Space>& model, const TimeSpan& time,
                          const ObserverOf<Space>& observer, const OutOfPlane* rest = nullptr);

}  // namespace floe
