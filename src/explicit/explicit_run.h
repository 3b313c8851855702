/// \file
/// What the types of explicit dynamics share beside DynamicRun: a step below the stable one, also
/// where that falls in the course of the run.
#pragma once

#include "explicit/explicit.h"
#include "explicit/stable_step.h"
#include "run/dynamic_run.h"

namespace floe {

/// The stable step is found at the beginning and again, as often as that costs 1 % of the steps. It
/// is found at once where the forces' own fastest rates (LimitsStep::rate_estimate), looked at with
/// each sample, have grown so far that it may have fallen below what dt needs. `dt: auto` needs it
/// where half of what `safety` leaves is used up, and takes shorter steps from there on; a given
/// step ends the run when it is no longer stable. A run whose stable step does not fall so far goes
/// on as if nobody had looked, to the last bit.
template <class Space>
class ExplicitRun : public DynamicRun<Space> {
 public:
  ExplicitRun(std::string_view type, Model<Space>& model, const ExplicitOptions& options,
              const Observer<Space>& observer);

 protected:
  /// At the state, whose wrenches must be known afterwards as they were before.
  virtual StableStep find_stable_step() = 0;
  /// Takes over that the next step is another than `before`; the state's wrenches are known.
  virtual void step_changed(TS ts, double before) = 0;
  void persist_own(Archive& archive) override;
  void add_to(RunPlan& plan) const override;
  virtual int evaluations_a_step() const { return 1; }

  /// The given step, or from the stable one. \throws InputError for a given one above it that was
  /// not asked for all the same, and if there is neither
  void choose_step();
  /// Between two steps: looks at the stable step if that is due. False: the run ends here.
  bool keep_step_stable(TS ts);

  const ExplicitOptions& explicit_options() const { return explicit_options_; }

 private:
  StableStep look();
  bool look_is_due();
  double rate_estimate();
  typename LimitsStep<Space>::Limit step_limit();
  double own_stiffness();
  double needed() const;

  const ExplicitOptions& explicit_options_;
  // Of the last look:
  std::int64_t last_look_ = 0, evaluations_ = 0;
  double last_stable_ = 0, last_rate_ = 0, last_own_ = 0, seconds_an_evaluation_ = 0;
};

/// Newton's equations by PETSc's explicit Runge-Kutta methods, all of their -ts_rk_type, on bodies'
/// records as vectors; the step fixed, or PETSc's -ts_adapt_type basic. \throws InputError
RunResult run_rk(Model<Spatial>& model, const ExplicitOptions& options,
                 const Observer<Spatial>& observer);

}  // namespace floe
