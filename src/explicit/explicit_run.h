/// \file
/// The part of a run that all explicit integrators share on top of DynamicRun: a step below the
/// stable step, also where the stable step falls during the run.
#pragma once

#include "explicit/explicit.h"
#include "run/dynamic_run.h"
#include "stability/stable_step.h"

namespace floe {

/// A run whose step stays below the stable step (model.md, "Explicit dynamics"). The stable step is
/// searched at the start and again as often as that costs 1 % of the steps. It is searched
/// immediately where the forces' own fastest rates (LimitsStep::rate_estimate), checked with each
/// sample, have grown so far that the stable step may have fallen below the one that dt needs. `dt:
/// auto` takes shorter steps once half of the margin that `safety` leaves is used up; a given step
/// ends the run when it is no longer stable. A run whose stable step does not fall so far is the
/// same to the last bit as without these searches.
template <class Space>
class ExplicitRun : public DynamicRun<Space> {
 public:
  ExplicitRun(std::string_view type, Model<Space>& model, const ExplicitOptions& options,
              Observer<Space> observer);

 protected:
  /// Searches the stable step at the state; the state's wrenches must be known afterwards as
  /// before.
  virtual StableStep find_stable_step() = 0;
  /// Called when the next step differs from `before` [s]; the state's wrenches are known.
  virtual void step_changed(double before) = 0;
  void persist_own(Archive& archive) override;
  void add_to(RunPlan& plan) const override;
  virtual int evaluations_a_step() const { return 1; }

  /// Takes the given step, or a step from the stable one.
  /// \throws InputError for a given step above the stable one unless allow_unstable is set, and if
  ///   neither a given nor a stable step exists
  void choose_step();
  /// Searches the stable step between two steps if that is due. False: the run ends here.
  bool keep_step_stable();

  const ExplicitOptions& explicit_options() const { return explicit_options_; }

 private:
  StableStep look();
  bool look_is_due();
  double rate_estimate();
  typename LimitsStep<Space>::Limit step_limit();
  double own_stiffness();
  double automatic(double stable) const;
  std::string resolved_motion() const;
  double needed() const;

  const ExplicitOptions explicit_options_;
  // Results of the last search:
  std::int64_t last_look_ = 0, evaluations_ = 0;
  double last_stable_ = 0, last_rate_ = 0, last_own_ = 0, seconds_an_evaluation_ = 0;
};

/// Integrates Newton's equations by PETSc's explicit Runge-Kutta methods (all -ts_rk_type) on
/// bodies' records as vectors, with a fixed step or PETSc's -ts_adapt_type basic (model.md,
/// "Explicit dynamics"). Collective. \throws InputError
std::unique_ptr<Run> make_rk_run(Model<Spatial>& model, const ExplicitOptions& options,
                                 Observer<Spatial> observer);

}  // namespace floe
