/// \file
/// What every integrator that moves bodies shares around its steps: the state and its forces,
/// samples, the energy ledger, limits, checkpoints, requests to stop, progress.
#pragma once

#include <petscts.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <exception>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "floe/base/audit.h"
#include "floe/base/log.h"
#include "floe/base/petsc.h"
#include "floe/solve/integrator.h"
#include "solve/ledger.h"

namespace floe {

/// Most steps that a TS is asked for at once: it counts with 32 bits. Tests make it small.
inline std::int64_t steps_of_a_piece = std::int64_t{1} << 30;  // NOLINT

/// A run with a step that divides it into equal ones, or with one that adapts. An integrator
/// derives from this, and in each step calls
///   evaluate()        the forces at t_n, unless it knows them,
///   sample_if_due()   false: the run ends here,
///   moved()           once the state is that of t_n+1; false: the run ends here,
///   look_around()     false: the run ends here, on request.
template <class Space>
class DynamicRun {
 public:
  /// \param what  a word for the progress line   \param type  of PETSc's TS: checkpoints of another
  /// are not taken   \param model, observer  must outlive this
  DynamicRun(std::string_view what, std::string_view type, Model<Space>& model,
             const DynamicOptions& options, const Observer<Space>& observer);
  virtual ~DynamicRun() = default;
  DynamicRun(const DynamicRun&) = delete;
  DynamicRun& operator=(const DynamicRun&) = delete;

  State<Space>& state() { return state_; }
  double dt() const { return dt_; }
  /// Of the last accepted state, where state() may be that of a stage [s].
  double time() const { return time_; }
  std::int64_t done() const { return done_; }

  /// Gives a TS the run's times and reads its options; -ts_dt, -ts_max_time and -ts_max_steps (of
  /// 64 bits) win.
  void read_options(TS ts);
  /// Goes on from the checkpoint that the options name, if they name one: then the step is its.
  bool restart();
  /// Takes a step as near to the wanted one as divides the run equally; if steps adapt, the wanted
  /// one to begin with. \throws InputError if that makes more steps than allowed
  void plan(double wanted);
  /// Tells options().on_plan. False: the run is not to be made.
  bool announce() const;
  /// The same for what is left of the run, in the middle of it.
  void replan(TS ts, double wanted);
  /// When the next step ends [s]; not for steps that adapt.
  double next_time() const {
    return time_base_ + static_cast<double>(done_ + 1 - step_base_) * dt_;
  }
  /// Solves with a TS whose steps call the run's functions through guarded(), from the run's state
  /// at the run's step; says how it ended.
  RunResult solve(TS ts);

  /// Does work inside a callback of PETSc, which no exception may cross: a verdict comes out of
  /// solve(). False if there was one.
  template <class Work>
  bool guarded(Work&& work) {
    try {
      return work();
    } catch (const Verdict&) {
      error_ = std::current_exception();
      return false;
    }
  }

 protected:
  /// This rank's kinetic energy and the boundaries' work on its bodies so far [J].
  struct Energies {
    double kinetic, boundary;
  };
  /// At the state, whose wrenches are known.
  virtual Energies energies() const = 0;
  /// What else it has to report of this rank's bodies at the state.
  virtual Columns own_columns() const { return {}; }
  /// What the integrator itself takes along over a restart, beside records, time and dt.
  virtual void remember_own(Memory& memory) = 0;
  /// Its PETSc objects, for audits.
  virtual std::vector<PetscObject> objects() const { return {}; }
  /// Compares the run's objects and its times over ranks, in audits. Collective then.
  void audit(const char* where) const;
  /// What it does between the run's beginning and the first step; false: the run ends here.
  virtual bool first() { return true; }

  /// What the plan says of the steps' time.
  virtual void add_to(RunPlan& /*plan*/) const {}
  /// \throws InputError for more steps than allowed
  void require_few_steps(double steps, double step) const;
  /// Whether the step adapts: then the last one is cut to end at the end.
  bool is_adaptive() const { return adaptive_; }
  void set_adaptive(bool adaptive) { adaptive_ = adaptive; }
  /// Whether the state after a step is the run's last, where the TS gives the reason why it ends:
  /// it ends, too, where a piece of the run does.
  bool is_last(TSConvergedReason reason) const {
    return reason == TS_CONVERGED_TIME || (reason == TS_CONVERGED_ITS && done_ >= last_step());
  }
  /// Progress is shown after so many steps.
  void show_every(std::int64_t steps) { show_every_ = steps; }
  /// Progress within a step.
  void show(const std::string& what) {
    if (progress_) progress_->update(time_, step_text() + ", " + what);
  }
  /// The same before work that takes about so long.
  void announce_work(const std::string& what, double seconds) {
    if (progress_) progress_->announce(time_, step_text() + ", " + what, seconds);
  }
  /// The next step [s].
  void set_dt(double dt) { dt_ = dt; }
  /// Says why a run ends that did not come to its end.
  void give_up(std::string why) { why_ = std::move(why); }

  Model<Space>& model() { return model_; }
  const Model<Space>& model() const { return model_; }
  const DynamicOptions& options() const { return options_; }
  /// What gave the step: "time: dt" or "ts_dt".
  const std::string& dt_key() const { return dt_key_; }
  const State<Space>& state() const { return state_; }
  const Wrenches<Space>& wrenches() const { return wrenches_; }
  RunResult& result() { return result_; }

  /// All forces at the state.
  void evaluate();
  /// Hands the state out if a sample is due at its time.
  bool sample_if_due() { return !due() || sample(); }
  /// Whether the state was a sample.
  bool sampled() const { return sampled_ == done_; }
  bool evaluate_and_sample_if_due() {
    if (!due()) return true;
    evaluate();
    return sample();
  }
  /// The state is that after one more step, at `time`. \param speed2  square of the largest speed
  /// of this rank's bodies [m^2/s^2]
  bool moved(double time, double speed2);
  /// Progress; a checkpoint or a stop if one is wished.
  bool look_around();

 private:
  void save();
  std::vector<std::string> column_names() const;
  static constexpr std::int64_t check_every = 100;  // steps between looks at the velocity limit
  static constexpr double early = 1e-6;             // of a step

  bool step(TS ts);
  void begin_piece(TS ts);
  void limit_steps(TS ts);
  /// Unless the time of its end comes first.
  std::int64_t last_step() const { return adaptive_ ? most_steps_ : std::min(steps_, most_steps_); }
  void set_sampling();
  bool due() const;
  bool sample(bool last = false);
  bool finish();
  std::string step_text() const;
  bool within_limits();
  void take_remarks();
  std::string where() const;
  void remember(Memory& memory);

  Model<Space>& model_;
  DynamicOptions options_;  // the command line's -ts_* included
  const Observer<Space>& observer_;
  State<Space> state_;
  Wrenches<Space> wrenches_;
  Ledger ledger_;
  Checkpoints checkpoints_;
  std::string_view what_;
  std::string type_;
  std::optional<Progress> progress_;
  RunResult result_;
  std::exception_ptr error_;
  std::array<double, 2> sample_every_{};
  bool given_ = false;  // the step, by the user
  double time_ = 0, dt_ = 0, next_sample_ = 0, time_base_ = 0, largest_ = 0;
  bool adaptive_ = false;
  // Step step_base_ ended at time_base_; equal ones follow.
  std::int64_t steps_ = 0, done_ = 0, before_ = 0, step_base_ = 0, sampled_ = -1;
  std::string dt_key_ = "time: dt";
  std::int64_t most_steps_ = std::numeric_limits<std::int64_t>::max();  // -ts_max_steps
  std::int64_t show_every_ = 1;
  std::int64_t piece_ = 0;  // the TS's step 0
  std::string why_, stopped_by_;
};

}  // namespace floe
