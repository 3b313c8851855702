/// \file
/// What every integrator that moves bodies shares around its steps: the state and its forces,
/// samples, the energy ledger, limits, checkpoints, requests to stop, progress.
#pragma once

#include <petscts.h>

#include <array>
#include <exception>
#include <optional>
#include <string>
#include <string_view>

#include "floe/base/log.h"
#include "floe/base/petsc.h"
#include "floe/solve/integrator.h"
#include "solve/ledger.h"

namespace floe {

/// A run with a step that divides it into equal ones. An integrator derives from this, and in each
/// step calls
///   evaluate()        the forces at t_n, unless it knows them,
///   sample_if_due()   false: the run ends here,
///   moved()           once the state is that of t_n+1; false: the run ends here,
///   look_around()     false: the run ends here, on request.
template <class Space>
class DynamicRun {
 public:
  /// \param what  a word for the progress line   \param model, observer  must outlive this
  DynamicRun(std::string_view what, Model<Space>& model, const DynamicOptions& options,
             const Observer<Space>& observer);
  virtual ~DynamicRun() = default;
  DynamicRun(const DynamicRun&) = delete;
  DynamicRun& operator=(const DynamicRun&) = delete;

  State<Space>& state() { return state_; }
  double dt() const { return dt_; }
  std::int64_t done() const { return done_; }

  /// Gives a TS the run's times and reads its options; -ts_dt, -ts_max_time and -ts_max_steps win.
  void read_options(TS ts);
  /// Goes on from the checkpoint that the options name, if they name one: then the step is its.
  bool restart();
  /// Takes a step as near to the wanted one as divides the run equally.
  void plan(double wanted);
  /// Solves with a TS whose steps call the run's functions through guarded(), from the run's state
  /// at the run's step; says how it ended.
  RunResult solve(TS ts);

  /// Does work inside a callback of PETSc, which no exception may cross: one that a user can put
  /// right comes out of solve(). False if there was one.
  template <class Work>
  bool guarded(Work&& work) {
    try {
      return work();
    } catch (const InputError&) {
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
  /// What the integrator itself takes along over a restart, beside records, time and dt.
  virtual void remember_own(Memory& memory) = 0;

  Model<Space>& model() { return model_; }
  const DynamicOptions& options() const { return options_; }
  const State<Space>& state() const { return state_; }
  const Wrenches<Space>& wrenches() const { return wrenches_; }
  RunResult& result() { return result_; }

  /// All forces at the state.
  void evaluate();
  /// Hands the state out if a sample is due at its time.
  bool sample_if_due() { return !due() || sample(); }
  /// The state is that after one more step, at `time`. \param speed2  square of the largest speed
  /// of this rank's bodies [m^2/s^2]
  bool moved(double time, double speed2);
  /// Progress; a checkpoint or a stop if one is wished.
  bool look_around();

 private:
  static constexpr std::int64_t check_every = 100;  // steps between looks at the velocity limit
  static constexpr double early = 1e-6;             // of a step

  void set_sampling();
  bool due() const;
  bool sample(bool last = false);
  bool finish();
  bool within_limits();
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
  std::optional<Progress> progress_;
  RunResult result_;
  std::exception_ptr error_;
  std::array<double, 2> sample_every_{};
  double dt_ = 0, next_sample_ = 0, largest_ = 0;
  std::int64_t steps_ = 0, done_ = 0, before_ = 0, sampled_ = -1;
  PetscInt most_steps_ = 0;  // -ts_max_steps
  std::string why_;
};

}  // namespace floe
