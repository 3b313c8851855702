#include "implicit/step_plan.h"

#include <algorithm>
#include <cmath>

namespace floe {

double StepPlan::begin(bool fixed, double given) {
  constexpr double of_the_run = 1e-3, of_a_ramp = 0.05;
  const double end = options_.end;
  fixed_ = fixed;
  double wanted = given;
  if (!(wanted > 0)) wanted = ramps_.empty() ? of_the_run * end : of_a_ramp * ramps_.front();
  wanted = std::min(wanted, end);
  if (fixed_) wanted = end / std::ceil(end / wanted * (1 - 1e-12));
  given_ = planned_ = last_ = wanted;
  return wanted;
}

void StepPlan::made(double h, double allowed) {
  const bool cut = h < (1 - rounding) * last_;  // by a failure or an error
  const bool shortened =
      !cut && h < (1 - rounding) * planned_;  // to end at a sample, a ramp's end or the run's end
  if (fixed_) {
    if (!shortened) planned_ = std::min(given_, cut ? h : 2 * planned_);
  } else {
    const bool shrinks = allowed < (1 - rounding) * h;
    planned_ = shortened && !shrinks ? std::max(allowed, planned_) : allowed;
  }
  last_ = h;
}

/// Next time at which a step must end: a sample with an interval of its own, the end of a ramp
/// (adaptive steps only), or the end of the run.
double StepPlan::next_due(double time) const {
  constexpr double nearly = 1e-9;
  double due = options_.end;
  for (const double every : {options_.history, options_.fields}) {
    if (every > 0) due = std::min(due, every * (std::floor(time / every + nearly) + 1));
  }
  if (fixed_) return due;
  for (const double end : ramps_) {
    if (end > (1 + nearly) * time) due = std::min(due, end);
  }
  return due;
}

/// Chooses equal steps up to the next due time. The last step is used again if it divides the
/// remaining time and is not much shorter, since its matrix is factorised.
double StepPlan::next(double time) {
  constexpr double much = 1.5;
  const double left = next_due(time) - time;
  if (!(left > 0)) return last_ = planned_;
  const double even = left / std::max(1.0, std::ceil(left / planned_ - rounding));
  const double again = std::round(left / last_);
  const bool divides = again >= 1 && std::abs(left / last_ - again) < rounding * again;
  const bool kept = divides && last_ <= (1 + rounding) * planned_ && even < much * last_;
  return last_ = kept ? left / again : even;
}

bool StepPlan::is_hopeless() const {
  constexpr double smallest_fraction = 1.0 / 4096;  // as in statics
  return fixed_ && planned_ < smallest_fraction * given_;
}

void StepPlan::persist(Archive& archive) {
  archive.common("given_step", given_, positive);
  archive.common("planned_step", planned_, positive);
  archive.common("step_before", last_, positive);
}

}  // namespace floe
