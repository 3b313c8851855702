/// \file
/// The interface of all forces, and the roles that some forces have and integrators ask for.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "floe/lattice/state.h"
#include "forces/device_model.h"
#include "forces/tangent.h"
#include "lattice/archive.h"
#include "lattice/partition.h"

namespace floe {

/// Named numbers for history.csv and summary.json, in order. Each rank adds its share; the sum over
/// the ranks is reported.
class Columns {
 public:
  void add(std::string name, double value) { values_.emplace_back(std::move(name), value); }
  const std::vector<std::pair<std::string, double>>& values() const { return values_; }
  std::vector<std::pair<std::string, double>>& values() { return values_; }

 private:
  std::vector<std::pair<std::string, double>> values_;
};

/// Role of a force with a tangent, for integrators that solve equations.
template <class Space>
class HasTangent {
 public:
  /// Adds minus the derivative of the wrenches to displacements and rotations.
  /// \returns false if nothing was added
  virtual bool add_tangent(const State<Space>& state, Tangent<Space>& tangent) const = 0;

 protected:
  ~HasTangent() = default;
};

/// Role of a force that depends on velocities, for integrators that solve equations.
template <class Space>
class Damps {
 public:
  /// Adds minus the derivative of the wrenches to the velocities.
  virtual void add_damping(const State<Space>& state, Tangent<Space>& tangent) const = 0;
  /// Adds the part of the wrenches that depends on velocities and takes energy out of the motion,
  /// for which no potential accounts [N, N m].
  virtual void add_losses(const State<Space>& state, Wrenches<Space>& wrenches) const = 0;

 protected:
  ~Damps() = default;
};

/// Tells when a force knows the powers of its wrenches with the velocities after a step.
enum class LaterPowers {
  at_once,             ///< after the step: DoesWork::powers_with()
  in_next_evaluation,  ///< in the next evaluation: DoesWork::kept_powers()
  never,
};

/// Role of a force that does work for which its potential does not account. The force tells powers;
/// the integrator keeps their integrals, the works, and hands them to Force::report(). All numbers
/// are this rank's share, negative where bodies lose energy.
template <class Space>
class DoesWork {
 public:
  /// Number of powers, and so of works. A force with the role Damps has one.
  virtual std::size_t works() const { return 1; }
  /// Writes the powers of the last evaluation, with the velocities of the state that it evaluated
  /// [W]. To be asked before the step is committed.
  virtual void powers(std::span<double> out) const = 0;

  virtual LaterPowers later_powers() const = 0;
  /// Writes the powers of the wrenches of the last evaluation with the velocities of another state
  /// [W], for LaterPowers::at_once. To be asked after the step was committed.
  /// \param state  after the step
  virtual void powers_with(const State<Space>& /*state*/, std::span<double> /*out*/) const {}
  /// Writes the powers of the wrenches that the last commit took over, with the velocities of the
  /// last evaluation [W], for LaterPowers::in_next_evaluation; 0 before the first commit.
  virtual void kept_powers(std::span<double> /*out*/) const {}

  /// Adds the works of the way from one state to the next to `works` [J], for integrators that know
  /// places at both ends of a step. Default: nothing, for forces without power where nothing moves,
  /// and for those with the role Damps.
  virtual void add_works(const State<Space>& /*from*/, const State<Space>& /*to*/,
                         std::span<double> /*works*/) const {}

 protected:
  ~DoesWork() = default;
};

/// Role of a force that limits the step of explicit dynamics (model.md, "Explicit dynamics").
template <class Space>
class LimitsStep {
 public:
  /// Upper bound of the stiffness against a displacement of an owned body [N/m].
  virtual double stiffness_bound(std::int32_t body) const = 0;

  /// Upper bounds of M^-1 K [1/s^2], and of M^-1 C [1/s] of dashpots that act on velocities at t_n.
  struct Rates {
    double stiffness = 0, damping = 0;
  };
  /// Stiffness and damping that the present state does not show (contacts that have not formed).
  /// The stiffness is added to that which the search for the stable step measures; dashpots take
  /// dt C of a velocity at t_n, which must be below 2. A force with a stiffness above zero takes no
  /// part in the measurement. Default: none.
  virtual Rates hidden_stiffness() const { return {}; }

  /// Cheap estimate of the fastest rate at which the force alone moves or stops one of this rank's
  /// bodies [1/s], for forces whose rate changes in a run (bodies reach the water, beams are
  /// pressed, drag grows with the speed). If the sum over the forces grows, the stable step is
  /// found anew. Either all ranks return a number or none does.
  virtual std::optional<double> rate_estimate(const State<Space>& /*state*/) const { return {}; }

  /// A limit of the step for another reason than stability.
  struct Limit {
    double dt = std::numeric_limits<double>::infinity();  ///< [s]
    std::string reason;
  };
  /// Limit that this rank's bodies set, such as their travel in a step against their widths.
  /// Default: none.
  virtual Limit step_limit(const State<Space>& /*state*/) const { return {}; }
  /// Longest step that resolves the motion by this force, the same on all ranks [s]. `time: dt:
  /// auto` takes no longer one; a given step may be longer. Default: none.
  virtual double resolved_step() const { return std::numeric_limits<double>::infinity(); }
  /// The motion that this step resolves, for the plan of a run.
  virtual std::string resolved_motion() const { return {}; }

 protected:
  ~LimitsStep() = default;
};

/// Role of a force with findings that it shares with other forces, or that it keeps over several
/// steps, in the evaluations of the steps of leapfrog. There all forces get the run's own state. In
/// other evaluations (other integrators, the search for the stable step) it does without them.
template <class Space>
class PreparesSteps {
 public:
  /// Called before the forces are evaluated for the step that begins at the state, perhaps several
  /// times at one state; steps are told apart by Commits::commit().
  virtual void before_evaluation(const State<Space>& state) = 0;
  /// Called after that.
  virtual void after_evaluation() = 0;

 protected:
  ~PreparesSteps() = default;
};

/// Role of a force whose wrenches depend on a history, which an accepted step changes: damage,
/// slip. Dynamics can use such a force only by integrators that evaluate once per step and never
/// take a step back.
template <class Space>
class Commits {
 public:
  /// Makes the findings of the last evaluation history, after a load step or a step of leapfrog.
  /// \param state  after the step; its velocities are those at state.velocity_time
  /// \param dt     length of the step [s]
  virtual void commit(const State<Space>& state, double dt) = 0;

 protected:
  ~Commits() = default;
};

/// Role of a force with numbers that a checkpoint keeps.
class Persists {
 public:
  /// Saves these numbers to the archive, or loads them from it. Collective.
  virtual void persist(Archive& archive) = 0;

 protected:
  ~Persists() = default;
};

/// Role of a force that depends on the time explicitly.
class DependsOnTime {
 public:
  /// Times at which the way in which the force changes does so: the end of its ramp, the rows of
  /// its table up to `end` [s]. Adaptive steps end there.
  virtual std::vector<double> changes(double end) const = 0;

 protected:
  ~DependsOnTime() = default;
};

/// Role of a force that acts between bodies once no beam joins them any more.
class TakesBrokenPairs {
 public:
  /// Makes pairs whose beam broke eligible from the next evaluation on; their present overlap
  /// counts as stress-free. Collective.
  /// \param pairs  global bodies; each rank may name other pairs
  virtual void release(std::span<const std::array<std::int32_t, 2>> pairs) = 0;

 protected:
  ~TakesBrokenPairs() = default;
};

/// A line for the user, given once: for example that a body passes through another.
struct Remark {
  double time = 0;  ///< [s]
  std::string text;
};
/// Role of a force that has remarks.
class Remarks {
 public:
  /// Remarks of this rank since the last call.
  virtual std::vector<Remark> take_remarks() = 0;

 protected:
  ~Remarks() = default;
};

/// Role of a force with work that differs between bodies, or that changes in a run. Ranks share the
/// bodies by it.
template <class Space>
class BearsLoad {
 public:
  /// Adds the time that a step takes for each owned body [ns]: what the force counts at the state
  /// and in its history, times what one of it took. No clock counts, so a run can be repeated.
  virtual void add_load(const State<Space>& state, std::span<double> load) const = 0;

 protected:
  ~BearsLoad() = default;
};

/// Forces on patches of the surfaces of obstacles at a time.
struct PatchSample {
  struct OfObstacle {
    std::string name;
    Vec3<double> force{};  ///< of all contacts with it [N]
    /// Number of a patch and force on it [N], of those that are touched.
    std::vector<std::pair<std::size_t, Vec3<double>>> loaded;
  };
  double time = 0;  ///< [s]
  std::vector<OfObstacle> obstacles;
};
/// Role of a force that acts on patches of the surfaces of obstacles.
class ActsOnPatches {
 public:
  /// Returns the forces of the last evaluation, which was at this state and is not committed yet;
  /// the same on all ranks. Collective.
  virtual PatchSample sample_patches(double time) = 0;

 protected:
  ~ActsOnPatches() = default;
};

/// Role of a force that a back end can compute by itself (src/device).
class OnDevice {
 public:
  /// Adds the numbers of the force.
  /// \throws InputError if a back end cannot compute it with these options
  virtual void describe(DeviceModel& model) = 0;

 protected:
  ~OnDevice() = default;
};

/// Roles of a force beside adding wrenches; null: the force does not have the role.
template <class Space>
struct Roles {
  HasTangent<Space>* tangent = nullptr;
  Damps<Space>* damping = nullptr;
  DoesWork<Space>* work = nullptr;
  LimitsStep<Space>* step = nullptr;
  PreparesSteps<Space>* prepares = nullptr;
  Commits<Space>* commits = nullptr;
  Persists* persists = nullptr;
  TakesBrokenPairs* broken_pairs = nullptr;
  DependsOnTime* time = nullptr;
  Remarks* remarks = nullptr;
  BearsLoad<Space>* load = nullptr;
  ActsOnPatches* patches = nullptr;  ///< null also where there are no patches
  OnDevice* device = nullptr;        ///< null: steps of the processor only
};

/// A force on the bodies of a part. An evaluation makes one virtual call per force; a scene that
/// does not name a force has no object for it.
template <class Space>
class Force {
 public:
  Force() = default;
  Force(const Force&) = delete;
  Force& operator=(const Force&) = delete;
  virtual ~Force() = default;

  virtual std::string_view name() const = 0;
  /// Adds the wrenches on owned bodies at state.time [N, N m]. May keep by-products of the
  /// evaluation (powers, pair lists); history changes by Commits::commit() only.
  virtual void add(const State<Space>& state, Wrenches<Space>& wrenches) = 0;
  /// Adds this rank's share of the energies [J] and counts of the force.
  /// \param state  of the last evaluation
  /// \param works  that the force has done until then [J], DoesWork::works() numbers; empty for a
  ///               force without that role
  virtual void report(const State<Space>& state, std::span<const double> works,
                      Columns& columns) const = 0;
  virtual Roles<Space> roles() { return {}; }
};

}  // namespace floe
