/// \file
/// The interface of all runs: an integrator takes a model from its first state to the scene's end,
/// and can pause at any accepted state.
#pragma once

#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "floe/base/petsc.h"
#include "floe/run/result.h"

namespace floe {

/// A state of a run in memory, to which the run can go back.
class RunState {
 public:
  virtual ~RunState() = default;
};

/// A run of an integrator. All functions but time() and outcome() are collective.
class Run {
 public:
  Run() = default;
  virtual ~Run() = default;
  Run(const Run&) = delete;
  Run& operator=(const Run&) = delete;

  /// Loads the checkpoint that the options name, or chooses the step, and hands the plan to
  /// on_plan. False: the run is not to be made. To be called once, before advance().
  /// \throws InputError if the options do not fit the model
  virtual bool prepare() = 0;
  /// Advances to the first accepted state at or after `until` [s], or to the end of the run.
  /// Pauses change no result. False: the run has ended.
  virtual bool advance(double until) = 0;
  /// Time of the last accepted state [s].
  virtual double time() const = 0;
  /// How the run ended; before the end its steps, times and warnings so far.
  virtual const RunResult& outcome() const = 0;

  /// Evaluates the forces at the last accepted state, unless they are known there. Changes no
  /// result.
  virtual void know_forces() {}
  /// To be called where a program has changed forces or motions since the last step.
  virtual void forces_have_changed() {}
  /// Columns of history.csv on energies and forces at the last accepted state; none for runs that
  /// sample every state.
  virtual std::vector<std::pair<std::string, double>> columns_now() { return {}; }
  /// Saves the state, and goes back to it, also after the end.
  /// \throws InputError if runs of this kind cannot go back
  virtual std::unique_ptr<const RunState> save() { return refuse_to_go_back(); }
  virtual void restore(const RunState& /*state*/) { (void)refuse_to_go_back(); }

 protected:
  static std::unique_ptr<const RunState> refuse_to_go_back() {
    throw InputError(
        "save: only runs with integrator: explicit by leapfrog and backend: cpu can go back to a "
        "state");
  }
};

/// Makes a whole run and returns how it ended; an empty result if it was not to be made.
/// Collective.
inline RunResult run_to_end(Run& run) {
  if (!run.prepare()) return {};
  (void)run.advance(std::numeric_limits<double>::infinity());
  return run.outcome();
}

}  // namespace floe
