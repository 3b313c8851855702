/// \file
/// The part of a run that all integrators of moving bodies share around their steps: the state and
/// its forces, samples, the energy ledger, limits, checkpoints, requests to stop, progress.
#pragma once

#include <petscts.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <exception>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/audit.h"
#include "floe/base/petsc.h"
#include "floe/files/log.h"
#include "run/integrator.h"
#include "run/ledger.h"
#include "run/run.h"
#include "run/work_ledger.h"

namespace floe {

/// Largest number of steps that a TS gets in a single solve, since a TS counts with 32 bits. Tests
/// make it small.
inline std::int64_t steps_of_a_piece = std::int64_t{1} << 30;  // NOLINT

/// A run with equal steps that divide its time, or with adaptive steps. An integrator derives from
/// this class, makes the TS and calls in each step
///   evaluate()        to compute the forces at t_n, unless they are known,
///   sample_if_due()   false: the run ends here,
///   moved()           when the state is that of t_n+1; false: the run ends here,
///   look_around()     false: the run ends here, on request.
template <class Space>
class DynamicRun : public Run {
 public:
  /// \param what  a word for the progress line
  /// \param type  type of PETSc's TS; checkpoints of other types are refused
  /// \param model  must outlive this object
  DynamicRun(std::string_view what, std::string_view type, Model<Space>& model,
             const DynamicOptions& options, Observer<Space> observer);

  bool advance(double until) final;
  double time() const final { return time_; }
  const RunResult& outcome() const final { return result_; }

  void know_forces() final;
  void forces_have_changed() final;
  std::vector<std::pair<std::string, double>> columns_now() final;
  std::unique_ptr<const RunState> save() final;
  void restore(const RunState& state) final;

  State<Space>& state() { return state_; }
  double dt() const { return dt_; }
  std::int64_t done() const { return done_; }

  /// Gives the TS the run's times and reads the TS options; -ts_dt, -ts_max_time and -ts_max_steps
  /// (of 64 bits) override the scene.
  void read_options();
  /// Goes on from the checkpoint that the options name and takes over its step. False if they name
  /// none. Collective. \throws InputError if the checkpoint does not fit the run
  bool restart();
  /// Chooses the step nearest to the wanted one [s] that divides the run equally. Adaptive steps
  /// begin with the wanted one.
  /// \throws InputError if that makes more steps than allowed
  void plan(double wanted);
  /// Passes the plan to options().on_plan. False if the run is not to be made.
  bool announce() const;
  /// Plans the rest of a run anew from the present time.
  void replan(double wanted);
  /// End time of the next step [s]; not for adaptive steps.
  double next_time() const {
    return time_base_ + static_cast<double>(done_ + 1 - step_base_) * dt_;
  }
  /// Does work inside a callback of PETSc, which no exception may cross. A verdict is kept and
  /// thrown by advance(). False if there was one, or if the work returned false.
  template <class Work>
  bool guarded(Work&& work) {
    try {
      return work();
    } catch (const Verdict&) {
      error_ = std::current_exception();
      return false;
    }
  }
  /// Does the work after a step inside the TS's post-step callback, and ends the solve if the run
  /// ends or pauses here.
  template <class Work>
  void after_step(Work&& work) {
    TSConvergedReason reason = TS_CONVERGED_ITERATING;
    if (!guarded(std::forward<Work>(work))) {
      check(TSSetConvergedReason(ts_, TS_DIVERGED_STEP_REJECTED));
      return;
    }
    check(TSGetConvergedReason(ts_, &reason));
    if (reason == TS_CONVERGED_ITERATING && adaptive_ && is_paused())
      check(TSSetConvergedReason(ts_, TS_CONVERGED_USER));
  }

 protected:
  /// Kinetic energy of this rank's bodies, and the boundaries' work on them since the start [J].
  struct Energies {
    double kinetic, boundary;
  };
  /// Energies at the state, whose wrenches are known.
  virtual Energies energies() const = 0;
  /// Works of the forces at the state, whose wrenches are known [J]. Default: as in the ledger.
  virtual std::vector<double> works() const { return {works_.all().begin(), works_.all().end()}; }
  /// Further columns of the integrator, for this rank's bodies at the state.
  virtual Columns own_columns() const { return {}; }
  /// Saves or loads the integrator's own history, apart from records, time and dt.
  virtual void persist_own(Archive& archive) = 0;
  /// Adapts the integrator's objects to a model that has been divided anew; the state follows. An
  /// integrator that leaves this out is given neither DynamicOptions::balance nor supply.
  virtual void follow_model() {}
  /// Brings the state, the works and the integrator's history to where they are read, for
  /// integrators that keep them elsewhere.
  virtual void bring_state() {}
  /// Makes steps known that have been counted and not made yet.
  virtual void finish_steps() {}
  /// Whether a state at a pause is all that later steps need: then runs can go back to it.
  virtual bool can_go_back() const { return false; }
  /// Evaluates the forces at the start, with the velocities there, as the run's first step wants
  /// them. For integrators that can go back.
  virtual void begin_again() {}
  /// PETSc objects of the integrator that audits compare.
  virtual std::vector<PetscObject> objects() const { return {}; }
  /// Compares the run's objects and times over ranks if auditing is on; collective then.
  void audit(const char* where) const;
  /// Work of the integrator between the start of the run and the first step. False: the run ends
  /// here.
  virtual bool first() { return true; }

  /// Adds the integrator's estimates (the time of a step) to the plan.
  virtual void add_to(RunPlan& /*plan*/) const {}
  /// \throws InputError for more steps than allowed
  void require_few_steps(double steps, double step) const;
  /// Whether the step adapts. The last step is then cut to end at the run's end.
  bool is_adaptive() const { return adaptive_; }
  void set_adaptive(bool adaptive) { adaptive_ = adaptive; }
  /// Whether the state after a step is the last of the run. The TS's reason does not tell by
  /// itself: a TS also ends where a piece of the run ends.
  bool is_last(TSConvergedReason reason) const {
    return reason == TS_CONVERGED_TIME || (reason == TS_CONVERGED_ITS && done_ >= last_step());
  }
  /// Sets the number of steps between lines of progress.
  void show_every(std::int64_t steps) { show_every_ = steps; }
  /// Shows progress within a step.
  void show(const std::string& what) {
    if (progress_) progress_->update(time_, step_text() + ", " + what);
  }
  /// Shows progress before work that takes about `seconds`.
  void announce_work(const std::string& what, double seconds) {
    if (progress_) progress_->announce(time_, step_text() + ", " + what, seconds);
  }
  /// Sets the next step [s].
  void set_dt(double dt) { dt_ = dt; }
  /// Sets the reason why a run ends before its end.
  void give_up(std::string why) { why_ = std::move(why); }

  Model<Space>& model() { return model_; }
  const Model<Space>& model() const { return model_; }
  const DynamicOptions& options() const { return options_; }
  /// Whether ice has joined or left since settle().
  bool ice_has_changed() const { return ice_has_changed_; }
  void settle() { ice_has_changed_ = false; }
  /// Key that gave the step: "time: dt" or "ts_dt".
  const std::string& dt_key() const { return dt_key_; }
  const State<Space>& state() const { return state_; }
  const Wrenches<Space>& wrenches() const { return wrenches_; }
  Wrenches<Space>& wrenches() { return wrenches_; }
  RunResult& result() { return result_; }
  /// The works of the forces, to which the integrator adds.
  WorkLedger& work_ledger() { return works_; }

  /// Updates the ghosts and evaluates all forces at the state. Collective.
  virtual void evaluate();
  /// Hands the state to the observer if a sample is due at its time. False: the run ends here.
  bool sample_if_due() { return !due() || sample(); }
  bool due() const;
  /// Whether a sample was due at the present state and was taken; also where a run is in parts,
  /// each of which samples its last state.
  bool sampled_when_due() const { return sampled_when_due_ == done_; }
  bool evaluate_and_sample_if_due() {
    if (!due()) return true;
    evaluate();
    return sample();
  }
  /// Counts a step after which the state is that of `time` [s]. False: the run ends here.
  /// \param speed2  square of the largest speed of this rank's bodies [m^2/s^2]
  bool moved(double time, double speed2);
  /// Takes note of the square of a speed that a body has had [m^2/s^2].
  void note_speed2(double speed2) {
    largest_ = std::isfinite(speed2) ? std::max(largest_, speed2) : speed2;
  }
  /// Shows progress; writes a checkpoint or stops if that is due. False: the run ends here.
  bool look_around();

  Handle<TS> ts_;

 private:
  /// Where advance() has left the run.
  enum class Stand { prepared, running, ended };
  /// Why a TS has come back.
  enum class Return { pause, end, failure };

  void write_checkpoint();
  std::vector<std::int32_t> owners() const;
  std::vector<std::string> column_names() const;
  // Steps between checks of the velocity limit.
  static constexpr std::int64_t check_every = 100;
  static constexpr double early = 1e-6;  // a sample may be early by this part of a step

  void begin_steps();
  Return make_steps();
  void begin_piece();
  void limit_steps();
  std::int64_t pause_step() const;
  bool is_paused() const {
    return adaptive_ ? time_ >= pause_ - early * dt_ : done_ >= pause_step();
  }
  void move_bodies_if_due();
  void move_bodies(const std::vector<std::int32_t>& owner);
  void change_ice_if_due();
  void change_ice();
  void divide(const std::function<Renumbering()>& work);
  void follow_division();
  /// Means over the bodies of the far edge, with which ice joins.
  struct EdgeMotion {
    double x = 0;  ///< at rest [m]
    std::array<double, 2> shift{}, speed{};
    double strain = 0;
  };
  std::optional<EdgeMotion> edge_motion() const;
  double way_of_edge() const;
  void begin_joined();
  std::vector<double> places_of_edge(double time) const;
  IceNow ice_now() const;
  void add_to(IceAmount& amount, const std::function<bool(std::int32_t)>& counts) const;
  double energy_balance();
  std::vector<std::pair<std::string, double>> ledger_columns() const;
  void take_up_state();
  void count_steps();
  void end();
  /// Last step of the run, unless its end time comes first.
  std::int64_t last_step() const { return adaptive_ ? most_steps_ : std::min(steps_, most_steps_); }
  void set_sampling();
  bool sample(bool last = false);
  bool finish();
  std::string step_text() const;
  bool within_limits();
  void take_remarks();
  std::string where();
  void persist(Archive& archive);
  void persist_ice(Archive& archive);

  Model<Space>& model_;
  DynamicOptions options_;  // with the command line's -ts_* options
  const Observer<Space> observer_;
  State<Space> state_;
  Wrenches<Space> wrenches_;
  WorkLedger works_;
  Ledger ledger_;
  Checkpoints checkpoints_;
  std::optional<RankBalance> balance_;
  // Steps of looks at the balance. A checkpoint of a step is made before the look after it.
  std::int64_t next_look_ = std::numeric_limits<std::int64_t>::max(), looked_ = -1;
  IceAccount ice_;
  std::optional<EdgeMotion> edge_;  ///< with which the next ice joins
  bool ice_has_changed_ = false;
  std::string_view what_;
  std::string type_;
  std::optional<Progress> progress_;
  RunResult result_;
  std::exception_ptr error_;
  std::array<double, 3> sample_every_{};
  bool given_ = false;  // the user gave the step
  double time_ = 0, dt_ = 0, next_sample_ = 0, time_base_ = 0, largest_ = 0;
  bool adaptive_ = false;
  // Step step_base_ ended at time_base_; equal steps follow.
  std::int64_t steps_ = 0, done_ = 0, before_ = 0, step_base_ = 0, sampled_ = -1,
               sampled_when_due_ = -1;
  std::string dt_key_ = "time: dt";
  std::int64_t most_steps_ = std::numeric_limits<std::int64_t>::max();  // -ts_max_steps
  std::int64_t show_every_ = 1;
  std::int64_t known_ = 0;  // step of the state of which the forces are known, at a pause
  std::int64_t piece_ = 0;  // step of the run that is the TS's step 0
  std::string why_, stopped_by_;
  Stand stand_ = Stand::prepared;
  double pause_ = std::numeric_limits<double>::infinity();  // time of the next pause
};

}  // namespace floe
