/// \file
/// A scene's run as an object: it is built, stepped, watched and asked for its results. The program
/// floe is one user of it; examples/library.cpp is another.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "floe/base/rotation.h"
#include "floe/run/result.h"
#include "floe/scene.h"

namespace floe {

/// One sample of a run: a row of history.csv. The same on all ranks.
struct Record {
  double time = 0;  ///< [s]
  std::int64_t step = 0;
  /// Names and values of the columns, SI units, in the order of history.csv (model.md, "Files").
  std::vector<std::pair<std::string, double>> columns;
};

/// Place and motion of a body.
struct BodyState {
  std::int32_t body = 0;    ///< index in the lattice
  Vec3<double> position{};  ///< of the centroid [m]
  Quat<double> rotation{};  ///< from rest, w x y z; linearised with `kinematics: linear`
  Vec3<double> velocity{};  ///< [m/s]
  Vec3<double> spin{};      ///< angular velocity [rad/s], world axes
};

/// Results of a run.
struct Results {
  RunResult run;             ///< how it ended
  std::string summary_json;  ///< the text of summary.json
  std::string text;          ///< the lines that the program floe prints at the end
};

/// Settings that are no part of the scene.
struct SimulationSettings {
  bool talks = false;  ///< whether rank 0 prints the model, the plan and warnings
  double began = 0;    ///< MPI_Wtime() at which the summary's wall time begins; 0: construction
};

/// A run of a scene from its first state to its end. It writes the scene's output folder as the
/// program floe does. All functions are collective: all ranks call them alike. An error of the
/// input raises InputError, a run that cannot go on RunFailed; the folder's summary.json then says
/// so. A Session must live as long as the simulation.
class Simulation {
 public:
  /// Called with each sample.
  using Observer = std::function<void(const Record&)>;

  /// Locks the output folder, makes the lattice and the model. With `check` in the scene nothing
  /// is locked or written, and the run ends before its first step.
  /// \throws InputError if the scene, its files or its folder cannot be used
  explicit Simulation(Scene scene, const SimulationSettings& settings = {});
  /// Ends a run that has not reached its end: its summary.json says that it was ended.
  ~Simulation();
  Simulation(Simulation&&) noexcept;
  Simulation& operator=(Simulation&&) noexcept;

  /// Sets the observer of the samples that follow.
  void on_sample(Observer observer);
  /// Advances to the first accepted state at or after `time` [s], or to the end of the run. Pauses
  /// change no result. False: the run has ended.
  bool step_to(double time);
  /// Runs to the end and returns the results.
  const Results& run();
  /// Ends the run, at its end or before it, writes summary.json, and returns the results. The
  /// output folder stays locked until the simulation is destroyed.
  const Results& results();

  /// Time of the last accepted state [s].
  double time() const;
  const Scene& scene() const;
  /// Places and motions of this rank's bodies at the last accepted state, in the order of the
  /// lattice. Leapfrog's velocities lag half a step behind.
  std::vector<BodyState> bodies() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace floe
