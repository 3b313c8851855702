// floe's own TS types on an oscillator, x'' = -x: everything that they use of PETSc's private
// header does what it is taken for, whatever release of PETSc is installed.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "explicit/leapfrog.h"
#include "floe/base/petsc.h"
#include "implicit/liealpha.h"
#include "support/implicit_run.h"
#include "support/second_order.h"

namespace floe::test {
namespace {

/// Leapfrog on raw numbers, as explicit runs step their bodies: PETSc's vector lies over them.
class Leapfrog {
 public:
  explicit Leapfrog(double dt) {
    x_[1] = -0.5 * dt * x_[0];  // the velocity is half a step behind; here it is half a step ahead
    check(VecCreateSeqWithArray(PETSC_COMM_SELF, 1, 1, x_.data(), solution_.put()));
    register_leapfrog();
    check(TSCreate(PETSC_COMM_SELF, ts_.put()));
    check(TSSetType(ts_, ts_leapfrog));
    check(TSSetSolution(ts_, solution_));
    check(TSSetTimeStep(ts_, dt));
    check(TSSetMaxTime(ts_, 1e30));
    check(TSSetExactFinalTime(ts_, TS_EXACTFINALTIME_STEPOVER));
    check(TSSetErrorIfStepFails(ts_, PETSC_FALSE));
    check(TSMonitorSet(ts_, record, this, nullptr));
    set_leapfrog_step(ts_, &step_);
  }
  Leapfrog(const Leapfrog&) = delete;
  Leapfrog& operator=(const Leapfrog&) = delete;

  void run(int steps) {
    check(TSSetMaxSteps(ts_, steps));
    check(TSSetFromOptions(ts_));
    check(TSSolve(ts_, nullptr));
  }
  TS ts() const { return ts_; }
  double x() const { return x_[0]; }

  std::vector<double> times, norms;
  int calls = 0;
  int fail_at = -1;  ///< this call asks for the end

 private:
  static PetscErrorCode record(TS, PetscInt, PetscReal time, Vec solution, void* self) noexcept {
    auto& me = *static_cast<Leapfrog*>(self);
    PetscReal norm = 0;
    check(VecNorm(solution, NORM_2, &norm));
    me.times.push_back(time);
    me.norms.push_back(norm);
    return PetscErrorCode{0};
  }
  bool step(double dt) {
    if (calls++ == fail_at) return false;
    x_[0] += dt * x_[1];
    x_[1] -= dt * x_[0];
    return true;
  }

  std::array<double, 2> x_{1, 0};
  LeapfrogStep step_ = [this](double dt) { return step(dt); };
  Handle<Vec> solution_;
  Handle<TS> ts_;
};

TSConvergedReason reason_of(TS ts) {
  TSConvergedReason reason = TS_CONVERGED_ITERATING;
  check(TSGetConvergedReason(ts, &reason));
  return reason;
}

TEST(TsTypes, LeapfrogStepsItsOwnNumbersAndTellsPetsc) {
  const double dt = 0.01;
  const int steps = 300;
  Leapfrog run(dt);
  run.run(steps);
  PetscInt done = 0;
  check(TSGetStepNumber(run.ts(), &done));
  EXPECT_EQ(done, steps);
  EXPECT_EQ(run.calls, steps);
  EXPECT_EQ(reason_of(run.ts()), TS_CONVERGED_ITS);
  EXPECT_NEAR(run.x(), std::cos(steps * dt), 1e-4);
  ASSERT_EQ(run.times.size(), steps + 1U);
  for (std::size_t n = 0; n < run.times.size(); ++n) {
    EXPECT_NEAR(run.times[n], static_cast<double>(n) * dt, 1e-12);
    // PETSc keeps a norm until it hears that the vector has changed.
    EXPECT_NEAR(run.norms[n], std::abs(std::cos(static_cast<double>(n) * dt)), 1e-4);
  }
}

TEST(TsTypes, LeapfrogStopsWhenItsStepSaysSo) {
  Leapfrog run(0.01);
  run.fail_at = 5;
  run.run(300);
  EXPECT_EQ(run.calls, 6);
  EXPECT_EQ(reason_of(run.ts()), TS_DIVERGED_STEP_REJECTED);
  PetscReal time = 0;
  check(TSGetTime(run.ts(), &time));
  EXPECT_NEAR(time, 0.05, 1e-12);
}

TEST(TsTypes, LeapfrogHasAFixedStep) {
  Leapfrog run(0.01);
  run.run(1);
  TSAdapt adapt = nullptr;
  TSAdaptType type = nullptr;
  check(TSGetAdapt(run.ts(), &adapt));
  check(TSAdaptGetType(adapt, &type));
  EXPECT_STREQ(type, TSADAPTNONE);
}

const Vector one = Vector::Ones(1), zero = Vector::Zero(1);

TEST(TsTypes, LieAlphaSolvesEachStepAndTellsPetsc) {
  System system = swing();
  Stepper run(system, ts_liealpha, one, zero);
  run.run(300, 3);
  EXPECT_NEAR(run.x()[0], std::cos(3.0), 1e-3);
  EXPECT_NEAR(run.v()[0], -std::sin(3.0), 1e-3);
  PetscReal time = 0;
  PetscInt newton = 0, linear = 0, done = 0;
  check(TSGetTime(run.ts(), &time));
  check(TSGetStepNumber(run.ts(), &done));
  check(TSGetSNESIterations(run.ts(), &newton));
  check(TSGetKSPIterations(run.ts(), &linear));
  EXPECT_NEAR(time, 3, 1e-12);
  EXPECT_EQ(done, 300);
  EXPECT_GE(newton, 300);
  EXPECT_EQ(linear, newton);
  EXPECT_EQ(reason_of(run.ts()), TS_CONVERGED_ITS);
}

TEST(TsTypes, LieAlphaIsGivenItsOptions) {
  std::array<double, 2> amplitude{};
  for (const int k : {0, 1}) {
    const PetscOption option("-ts_liealpha_radius", k == 0 ? "1" : "0");
    System system = swing();
    Stepper run(system, ts_liealpha, one, zero);
    run.run(100, 100);
    amplitude[static_cast<std::size_t>(k)] = std::hypot(run.x()[0], run.v()[0]);
  }
  EXPECT_NEAR(amplitude[0], 1, 0.2);
  EXPECT_LT(amplitude[1], 0.1);
}

/// PETSc's adaptor takes the type's estimate of the error, and its tolerances.
TEST(TsTypes, LieAlphaAdaptsItsStepToTheTolerance) {
  const PetscOption adapt("-ts_adapt_type", "basic"), relative("-ts_rtol", "1e-5"),
      absolute("-ts_atol", "1e-5");
  System system = swing();
  Stepper run(system, ts_liealpha, one, zero);
  run.run(3000, 3);
  ASSERT_FALSE(run.steps_taken.empty());
  EXPECT_GT(run.steps_taken.back(), 2 * run.steps_taken.front());
}

TEST(TsTypes, LieAlphaGivesUpAfterTheRejectionsThatAreAllowed) {
  const PetscOption rejections("-ts_max_reject", "3");
  System system = swing();
  system.force = [](double, const Vector& x, const Vector&) -> Vector { return x * std::nan(""); };
  Stepper run(system, ts_liealpha, one, zero);
  run.run(10, 1);
  EXPECT_LT(reason_of(run.ts()), 0);
  PetscInt rejected = 0;
  check(TSGetStepRejections(run.ts(), &rejected));
  EXPECT_GE(rejected, 1);
}

}  // namespace
}  // namespace floe::test
