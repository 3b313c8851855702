// How long implicit steps are: equal parts of the way to what is due, kept while they serve.
#include "implicit/step_plan.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace floe::test {
namespace {

/// Steps that a plan makes up to the end when errors always allow the same step.
std::vector<double> steps_of(const DynamicOptions& options, const std::vector<double>& ramps,
                             bool fixed, double given, double allowed) {
  StepPlan plan(options, ramps);
  plan.begin(fixed, given);
  std::vector<double> steps;
  double time = 0;
  while (time < options.end * (1 - 1e-12) && steps.size() < 1000) {
    const double h = plan.next(time);
    steps.push_back(h);
    time += h;
    plan.made(h, allowed);
  }
  EXPECT_NEAR(time, options.end, 1e-12 * options.end);
  return steps;
}

TEST(StepPlan, AGivenStepDividesTheRun) {
  DynamicOptions options;
  options.end = 1;
  const std::vector<double> steps = steps_of(options, {0.35}, true, 0.3, 0);
  ASSERT_EQ(steps.size(), 4U);  // ramps do not bend a given step
  for (const double h : steps) EXPECT_NEAR(h, 0.25, 1e-14);
}

TEST(StepPlan, StepsEndAtSamples) {
  DynamicOptions options;
  options.end = 1;
  options.history = 0.4;
  const std::vector<double> steps = steps_of(options, {}, true, 0.25, 0);
  const std::vector<double> expected{0.2, 0.2, 0.2, 0.2, 0.2};
  ASSERT_EQ(steps.size(), expected.size());
  for (std::size_t k = 0; k < steps.size(); ++k) EXPECT_NEAR(steps[k], expected[k], 1e-12);
}

TEST(StepPlan, AdaptiveStepsEndWhereRampsEnd) {
  DynamicOptions options;
  options.end = 2;
  const std::vector<double> steps = steps_of(options, {0.5, 1}, false, 0, 0.24);
  EXPECT_NEAR(steps.front(), 0.025, 1e-14);  // 1/20 of the first ramp
  double time = 0;
  bool half = false, whole = false;
  for (const double h : steps) {
    EXPECT_LE(h, 0.24 * (1 + 1e-6));
    time += h;
    half = half || std::abs(time - 0.5) < 1e-12;
    whole = whole || std::abs(time - 1) < 1e-12;
  }
  EXPECT_TRUE(half);
  EXPECT_TRUE(whole);
  EXPECT_LE(steps.size(), 12U);
}

/// A longer step that would divide what is left into parts hardly longer than the last one is not
/// worth a matrix.
TEST(StepPlan, AStepThatDividesWhatIsLeftStays) {
  DynamicOptions options;
  options.end = 1;
  StepPlan plan(options, {});
  plan.begin(false, 0.1);
  double time = plan.next(0);
  EXPECT_NEAR(time, 0.1, 1e-15);
  plan.made(0.1, 0.14);  // 7 steps of 0.1286 or 9 of 0.1
  EXPECT_NEAR(plan.next(time), 0.1, 1e-14);
  plan.made(0.1, 0.21);  // 4 of 0.2
  EXPECT_NEAR(plan.next(0.2), 0.2, 1e-14);
}

TEST(StepPlan, CutStepsGrowAgainOrAreHopeless) {
  DynamicOptions options;
  options.end = 1;
  StepPlan plan(options, {});
  plan.begin(true, 0.25);
  (void)plan.next(0);
  plan.made(0.0625, 0);  // Newton failed twice
  EXPECT_NEAR(plan.planned(), 0.0625, 1e-14);
  EXPECT_NEAR(plan.next(0.0625), 0.0625, 1e-14);
  plan.made(0.0625, 0);
  EXPECT_NEAR(plan.planned(), 0.125, 1e-14);
  EXPECT_FALSE(plan.is_hopeless());
  (void)plan.next(0.125);
  plan.made(1e-6, 0);
  EXPECT_TRUE(plan.is_hopeless());
}

}  // namespace
}  // namespace floe::test
