/// \file
/// What a run is going to do, and how it ended.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace floe {

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

}  // namespace floe
