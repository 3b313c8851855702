/// \file
/// Lengths of the steps of an implicit run: the given step, or the one that errors allow, adjusted
/// to end at samples, at the end of the run, and at ends of ramps if steps adapt.
#pragma once

#include <vector>

#include "run/integrator.h"

namespace floe {

/// Chooses the steps of an implicit run.
class StepPlan {
 public:
  /// \param options  must outlive this object
  /// \param ramps  ends of ramps [s], ascending
  StepPlan(const DynamicOptions& options, std::vector<double> ramps)
      : options_(options), ramps_(std::move(ramps)) {}

  /// Returns the first step: the given one, shortened to divide the run, otherwise a small part of
  /// the run or of the first ramp.
  /// \param fixed  whether the step is kept throughout
  /// \param given  the given step [s], 0 for none; with adaptive steps the first one
  double begin(bool fixed, double given);
  /// Updates the plan after a step.
  /// \param h  length of the step [s]
  /// \param allowed  next step that its error allows [s] (adaptive steps)
  void made(double h, double allowed);
  /// Returns the step to make from a time on [s].
  double next(double time);
  /// The next step if no time were due, and the given one [s].
  double planned() const { return planned_; }
  double given() const { return given_; }
  /// Whether failures of Newton have cut a given step to a negligible part.
  bool is_hopeless() const;
  void persist(Archive& archive);

 private:
  static constexpr double rounding = 1e-6;  // of a step

  double next_due(double time) const;

  const DynamicOptions& options_;
  std::vector<double> ramps_;
  bool fixed_ = false;
  double given_ = 0, planned_ = 0, last_ = 0;
};

}  // namespace floe
