/// \file
/// The plan of a run and its result.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace floe {

/// A largest or smallest load factor on a path.
struct LimitPoint {
  std::int64_t step;  ///< nearest
  double load_factor;
  bool is_maximum;
};

/// Result of a static run along a path.
struct PathResult {
  double load_factor = 0;  ///< of the last state
  double length = 0;       ///< of the path [m]
  std::vector<LimitPoint> limit_points;
  std::int64_t snap_backs = 0;  ///< steps in which load and displacement went back
  std::string end;              ///< why the path ended
};

/// Moves of bodies between ranks.
struct Moves {
  std::int64_t count = 0;
  double before = 0, after = 0;  ///< at the last move: largest load of a rank over the mean
};

/// Result of a run, for summary.json and the exit code.
struct RunResult {
  bool done = false;
  bool stopped = false;  ///< on request; a checkpoint has been written
  std::string message;
  std::int64_t steps = 0;      ///< since time 0
  std::int64_t steps_now = 0;  ///< explicit: since the start or restart
  std::int64_t newton_iterations = 0;
  std::int64_t factorisations = 0;  ///< quasistatic: factorisations of tangents
  std::string stepper;              ///< explicit: TS type that made the steps
  double dt = 0;                    ///< last step taken [s]
  double stable_dt = 0;             ///< explicit: the largest stable step [s]
  std::string limited_by;           ///< explicit: what limits the stable step
  std::int64_t unstable_modes =
      -1;                          ///< negative eigenvalues at the last equilibrium; -1: not known
  Moves moves;                     ///< of bodies between ranks
  std::optional<PathResult> path;  ///< static runs along a path
  std::vector<std::string> warnings;  ///< remarks of forces in order of time; on rank 0
};

/// Plan of a run, known before the first step.
struct RunPlan {
  double end = 0;             ///< [s]
  double dt = 0;              ///< first step [s]
  bool adaptive = false;      ///< steps follow the error, so their number is not known
  bool given = false;         ///< the user gave the step
  double stable_dt = 0;       ///< explicit: stable step [s]; else 0
  std::string limited_by;     ///< explicit: what limits the stable step
  std::string resolves;       ///< explicit: the motion for which dt: auto takes a shorter step
  double steps = 0;           ///< number of steps of the whole run; 0: not known
  double done = 0;            ///< steps already made, if the run goes on from a checkpoint
  double seconds_a_step = 0;  ///< wall time of a step [s]; 0: not known
  std::string measured;       ///< source of seconds_a_step
  double bytes = 0;           ///< memory that solvers will take [B]
};

/// Receives the plan before the first step. False: the run is not made.
using OnPlan = std::function<bool(const RunPlan&)>;

/// Larger numbers of steps are taken for a mistake in a unit: a year has 3e13 microseconds.
inline constexpr double default_most_steps = 1e11;

}  // namespace floe
