/// \file
/// How long the steps of an implicit run are: the given one, or the one that errors allow, made to
/// end where a step must: at samples, at the end, and where a ramp ends if steps adapt.
#pragma once

#include <vector>

#include "run/integrator.h"

namespace floe {

class StepPlan {
 public:
  /// \param ramps  ends of ramps [s], ascending
  StepPlan(const DynamicOptions& options, std::vector<double> ramps)
      : options_(options), ramps_(std::move(ramps)) {}

  /// The first step: a given one made to divide the run, otherwise a small part of the run or of
  /// the first ramp.
  /// \param given  the run's step throughout (else that of an adaptive run to begin with), 0: none
  double begin(bool fixed, double given);
  /// After a step. \param h  its length   \param allowed  what its error allows next (adaptive)
  void made(double h, double allowed);
  /// The step from a time on [s].
  double next(double time);
  /// What the next step would be if nothing was due, and the given one [s].
  double planned() const { return planned_; }
  double given() const { return given_; }
  /// Whether Newton has cut a given step to next to nothing.
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
