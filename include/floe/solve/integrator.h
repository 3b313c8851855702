/// \file
/// Integrators take a model from its first state to the scene's end and hand every accepted state
/// to an observer.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "floe/solve/checkpoint.h"
#include "floe/solve/model.h"

namespace floe {

/// An accepted state, with what is known of the step that led to it.
template <class Space>
struct Accepted {
  const State<Space>& state;
  const Wrenches<Space>& wrenches;  ///< of all forces, on owned bodies
  std::int64_t step;                ///< 0: the initial state
  std::vector<std::pair<std::string, double>> columns =
      {};             ///< what the integrator itself knows (energies)
  bool last = false;  ///< no other will follow
  std::vector<std::pair<std::string, double>> forces =
      {};  ///< what the forces reported then; empty: they can still be asked
};

/// How a run ended, for summary.json and the exit code.
struct RunResult {
  bool done = false;
  bool stopped = false;  ///< on request; a checkpoint has been written
  std::string message;
  std::int64_t steps = 0;      ///< since time 0
  std::int64_t steps_now = 0;  ///< explicit: since the start or restart
  std::int64_t newton_iterations = 0;
  std::int64_t factorisations = 0;    ///< quasistatic: of tangents
  std::string stepper;                ///< explicit: the type that stepped
  double dt = 0;                      ///< last step taken
  double stable_dt = 0;               ///< explicit: the largest stable step
  std::string limited_by;             ///< explicit: what limits it
  std::int64_t unstable_modes = -1;   ///< of the last equilibrium; -1: not known
  std::vector<std::string> warnings;  ///< what forces had to say, in order of time; on rank 0
};

/// What a run is going to do, known before its first step.
struct RunPlan {
  double end = 0;             ///< [s]
  double dt = 0;              ///< the first step [s]
  bool adaptive = false;      ///< steps follow the error: their number is not known
  bool given = false;         ///< the step, by the user
  double stable_dt = 0;       ///< explicit [s]; 0 otherwise
  std::string limited_by;     ///< explicit: what limits the stable step
  double steps = 0;           ///< in all; 0: not known
  double done = 0;            ///< of them, where the run goes on from a checkpoint
  double seconds_a_step = 0;  ///< by the clock; 0: not known
  std::string measured;       ///< what that rests on
  double bytes = 0;           ///< of memory that solvers will take
};

/// Is told before the first step. False: the run is not made.
using OnPlan = std::function<bool(const RunPlan&)>;

/// More steps than this are a mistake in a unit: a year has 3e13 microseconds.
inline constexpr double default_most_steps = 1e11;

struct TimeSpan {
  double end = 1;
  double dt = 0;  ///< 0: one step
  double most_steps = default_most_steps;
  OnPlan on_plan = nullptr;
};

template <class Space>
using Observer = std::function<void(const Accepted<Space>&)>;
/// Where the space follows from a model, so that a lambda will do.
template <class Space>
using ObserverOf = std::type_identity_t<Observer<Space>>;

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

/// What an integrator that moves bodies is told.
struct DynamicOptions {
  double end = 1;
  double dt = 0;                 ///< 0: the integrator's own choice
  double velocity_limit = 1000;  ///< of any body [m/s]
  double energy_limit = 0.1;     ///< of the energy balance's error over the energies that move
  double history = 0;            ///< time between samples [s]; 0: 200 over the run
  double fields = 0;             ///< further samples, for frames [s]; 0: none
  double most_steps = default_most_steps;  ///< a run that needs more is refused
  OnPlan on_plan = nullptr;
  CheckpointOptions checkpoint;
};

/// What explicit dynamics is told.
struct ExplicitOptions : DynamicOptions {
  double safety = 0.9;          ///< dt = 0: this part of the stable step
  bool allow_unstable = false;  ///< take a given dt above the stable step
};

/// Newton's equations by PETSc's TS: own type `leapfrog`, velocities half a step behind. Every
/// sample goes to the observer. Stops, with the last sample as last good state, when a velocity or
/// the energy balance crosses its limit or a number is not finite. Collective. \throws InputError
/// for a dt above the stable step, and for options of solvers that explicit dynamics does not use
template <class Space>
RunResult run_explicit(Model<Space>& model, const ExplicitOptions& options,
                       const ObserverOf<Space>& observer);

/// Why the stepper that the options choose takes spatial models only; empty if it does not.
std::string explicit_needs_space();

/// Newton's equations by PETSc's TS: own type `liealpha`, generalised-alpha on the rotation group,
/// with the exact tangent; any step. All of PETSc's -ts_adapt_*, -snes_*, -ksp_*, -pc_* and -mat_*
/// options apply. The given step is taken throughout (cut where Newton fails), without one steps
/// adapt to the error. Samples as run_explicit; where times between them are given, steps end
/// there. Collective. \throws InputError for a force with history and for another -ts_type
RunResult run_implicit(Model<Spatial>& model, const DynamicOptions& options,
                       const Observer<Spatial>& observer);

}  // namespace floe
