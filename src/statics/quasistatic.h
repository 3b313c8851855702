/// \file
/// Quasi-static runs: static equilibria, load step by load step.
#pragma once

#include <memory>
#include <vector>

#include "run/integrator.h"
#include "run/run.h"

namespace floe {

/// Time span of a static run in pseudo-time.
struct TimeSpan {
  double end = 1;
  double dt = 0;  ///< load step [s]; 0: one step
  double most_steps = default_most_steps;
  OnPlan on_plan = nullptr;
};

/// Forces and held unknowns that a planar model leaves out, by which the end of a static run
/// decides whether the equilibrium withstands a disturbance out of the plane.
struct OutOfPlane {
  std::vector<std::unique_ptr<Force<Spatial>>> forces;
  std::vector<std::uint8_t> held;  ///< per local body, bits of x y z rx ry rz: prescribed or pinned
};

/// Makes a run that finds equilibrium at pseudo-time 0 and after each load step up to the end: SNES
/// Newton with the exact tangent; the step is halved when Newton fails (model.md, "Static
/// solution"). All of PETSc's -snes_*, -ksp_*, -pc_*, -mat_* options apply; the default is Newton
/// with preonly + Cholesky by MUMPS on blocked symmetric storage. Collective. \param rest  for a
/// planar model: the part whose unstable modes count too; else null
///   must outlive the run, as the model
template <class Space>
std::unique_ptr<Run> make_quasistatic_run(Model<Space>& model, TimeSpan span,
                                          ObserverOf<Space> observer,
                                          const OutOfPlane* rest = nullptr);

/// Makes the whole run. Collective.
template <class Space>
RunResult run_quasistatic(Model<Space>& model, const TimeSpan& span, ObserverOf<Space> observer,
                          const OutOfPlane* rest = nullptr) {
  return run_to_end(*make_quasistatic_run(model, span, std::move(observer), rest));
}

}  // namespace floe
