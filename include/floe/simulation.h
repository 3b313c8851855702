/// \file
/// A scene's run as an object: it is built, stepped, watched and asked for its results. The program
/// floe is one user of it; examples/library.cpp is another.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "floe/base/rotation.h"
#include "floe/forces/body_force.h"
#include "floe/geometry/contact_of_pair.h"
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

/// All bodies of a model, in the order of their indices; one entry each.
struct BodyTable {
  /// Index in the lattice; where ice joins and leaves (supply), the name that a body keeps.
  std::vector<std::int32_t> index;
  std::vector<Vec3<double>> position;     ///< of the centroids [m]
  std::vector<Quat<double>> orientation;  ///< rotation since rest, w x y z
  std::vector<Vec3<double>> velocity;     ///< [m/s]
  std::vector<Vec3<double>> spin;         ///< in world axes [rad/s]
  std::vector<double> mass;               ///< [kg]
  std::vector<std::int32_t> fragment;     ///< connected piece, the heaviest is 0
};

/// All beams of a model, in the order of the lattice; one entry each.
struct BeamTable {
  std::vector<std::array<std::int32_t, 2>> bodies;  ///< positions in BodyTable
  /// At the middle of the beam, in its mean triad: N, Q2, Q3 [N], T, M2, M3 [N m].
  std::vector<std::array<double, 6>> section;
  std::vector<double> damage;  ///< 0 whole, 1 broken
};

/// An obstacle at the last accepted state.
struct ObstacleNow {
  std::string name;
  std::int32_t body = -1;                ///< that carries it, position in BodyTable; -1: none
  bool coupled = false;                  ///< whether the program moves or loads it
  Vec3<double> position{};               ///< of its point, or of the centre of its mass [m]
  Quat<double> orientation{1, 0, 0, 0};  ///< rotation since time 0
  Vec3<double> velocity{}, spin{};       ///< [m/s, rad/s]; of a body half a step before
  Vec3<double> force{}, moment{};        ///< by all bodies, about `position` [N, N m]
  Vec3<double> impulse{};                ///< integral of that force over the steps so far [N s]
};

/// Place and motion that a program gives an obstacle.
struct PlaceAndMotion {
  Vec3<double> position{};               ///< of its point [m]
  Quat<double> orientation{1, 0, 0, 0};  ///< rotation since time 0
  Vec3<double> velocity{}, spin{};       ///< [m/s, rad/s]
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
  /// Whether save() will be called: the whole lattice then stays in memory.
  bool goes_back = false;
  /// Names of obstacles that the program moves (prescribe) or, where they have a mass, loads
  /// (apply). For explicit runs by leapfrog.
  std::vector<std::string> coupled = {};
  /// Forces of the program. For explicit runs by leapfrog; the model is spatial.
  std::vector<BodyForce> forces = {};
  /// Whether this rank wants the run to pause now; asked a few times a second in explicit and
  /// implicit runs. Empty: never.
  std::function<bool()> wants_pause = nullptr;
};

/// A state of a simulation in memory. It may outlive the simulation.
class SavedState {
 public:
  virtual ~SavedState() = default;
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

  /// Prepares the run (stable step, plan), as the first step_to() does. False: it has ended.
  bool prepare();

  /// Time of the last accepted state [s].
  double time() const;
  /// Length of the last or, before it, of the first step [s].
  double dt() const;
  /// Whether the run has reached its end or failed.
  bool has_ended() const;
  /// How the run ended; before its end the steps so far.
  const RunResult& outcome() const;
  const Scene& scene() const;
  /// Places and motions of this rank's bodies at the last accepted state, in the order of the
  /// lattice. Leapfrog's velocities lag half a step behind.
  std::vector<BodyState> bodies() const;

  /// The same for the bodies of all ranks, on all ranks. Collective, as all that follows.
  BodyTable all_bodies() const;
  /// Forces and damage of all beams at the last accepted state.
  BeamTable beams() const;
  /// Contacts at the last accepted state, sorted by bodies; `a` and `b` are positions in BodyTable.
  std::vector<ContactOfPair> contacts();
  /// Energies and other columns of history.csv at the last accepted state, evaluated there; runs
  /// that sample every state give those of the last one.
  std::vector<std::pair<std::string, double>> columns();
  /// Obstacles at the last accepted state, in the order of the scene. Where forces are not known
  /// there, they are evaluated: about a step's work.
  std::vector<ObstacleNow> obstacles();
  /// Names of the obstacles, in the order of the scene.
  std::vector<std::string> obstacle_names() const;

  /// Moves a coupled obstacle without mass: from the present time on it is at `to` and goes on with
  /// its motion; with `until` [s] it goes from its present place and motion to `to` at that time,
  /// by cubics of time.
  /// \throws InputError for an obstacle that is not coupled, has a mass, or cannot turn
  void prescribe(const std::string& obstacle, const PlaceAndMotion& to,
                 std::optional<double> until = {});
  /// Loads a coupled obstacle that has a mass, until the next call.
  /// \param force, moment  about the centre of its mass, in world axes [N, N m]
  /// \throws InputError for an obstacle that is not coupled or has no mass
  void apply(const std::string& obstacle, const Vec3<double>& force, const Vec3<double>& moment);

  /// Keeps the present state in memory, and goes back to it, before results(): files of the output
  /// folder are cut back too. Later steps are the same bit for bit.
  /// \throws InputError if runs of this kind cannot go back, or without goes_back
  std::shared_ptr<const SavedState> save();
  void restore(const SavedState& state);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace floe
