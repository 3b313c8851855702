// The TS type liealpha by itself: order on oscillators and on a tumbling body, PETSc's alpha2 as a
// check, what it does to unresolved frequencies, adaptive steps, rejected steps, going on.
#include <gtest/gtest.h>

#include <Eigen/Dense>

#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "floe/base/petsc.h"
#include "floe/base/rotation.h"
#include "implicit/liealpha.h"
#include "support/implicit_run.h"
#include "support/record.h"
#include "support/second_order.h"

namespace floe::test {
namespace {

constexpr const char* section_name = "Implicit dynamics";
constexpr std::array radii{1.0, 0.8, 0.5, 0.0};

/// Two masses, linear and cubic springs, dashpots of both, driven.
System oscillator(double cubic = 4, double drive = 1) {
  System s;
  s.mass = (Matrix(2, 2) << 2, 0.3, 0.3, 1).finished();
  const Matrix k = (Matrix(2, 2) << 9, -3, -3, 5).finished();
  const Matrix c = (Matrix(2, 2) << 0.4, -0.1, -0.1, 0.3).finished();
  s.force = [=](double t, const Vector& x, const Vector& v) -> Vector {
    Vector f = -k * x - c * v;
    f[0] += drive * std::sin(1.7 * t) - cubic * x[0] * x[0] * x[0];
    return f;
  };
  s.slope = [=](double, const Vector& x, const Vector&) {
    Matrix kk = -k;
    kk(0, 0) -= 3 * cubic * x[0] * x[0];
    return std::pair<Matrix, Matrix>(kk, -c);
  };
  return s;
}

const Vector start_x = (Vector(2) << 0.7, -0.2).finished();
const Vector start_v = (Vector(2) << 0.1, 0.9).finished();

Vector end_of(System system, int steps, double end) {
  Stepper stepper(system, ts_liealpha, start_x, start_v);
  stepper.run(steps, end);
  Vector both(4);
  both << stepper.x(), stepper.v();
  return both;
}

TEST(LieAlpha, IsOfOrderTwoOnAnOscillator) {
  const double end = 3;
  for (const double rho : radii) {
    if (rho == 0.8 && !full_form()) continue;
    const PetscOption option = radius(rho);
    const Vector fine = end_of(oscillator(), full_form() ? 12800 : 6400, end);
    std::array<double, 3> error{};
    for (std::size_t k = 0; k < 3; ++k)
      error[k] = (end_of(oscillator(), 100 << k, end) - fine).lpNorm<Eigen::Infinity>();
    for (std::size_t k = 0; k + 1 < 3; ++k)
      verify({.section = section_name,
              .quantity = text("oscillator: order from %d and %d steps, radius %g", 100 << k,
                               200 << k, rho),
              .value = std::log2(error[k] / error[k + 1]),
              .reference = 2.0,
              .tolerance = 0.1,
              .note = "cubic spring, dashpots, driven; X and V"});
  }
}

TEST(LieAlpha, EqualsAlpha2AtRadiusOne) {
  const PetscOption option = radius(1), theirs("-ts_alpha_radius", "1");
  const double end = 5;
  std::array<Vector, 2> x, v;
  for (std::size_t k = 0; k < 2; ++k) {
    System system =
        oscillator(0, 0);  // on a linear one the trapezoidal and the midpoint rule agree
    Stepper stepper(system, k == 0 ? ts_liealpha : TSALPHA2, start_x, start_v);
    stepper.run(60, end);
    x[k] = stepper.x(), v[k] = stepper.v();
  }
  verify({.section = section_name,
          .quantity = "difference to PETSc's alpha2, radius 1",
          .value = std::max((x[0] - x[1]).lpNorm<Eigen::Infinity>(),
                            (v[0] - v[1]).lpNorm<Eigen::Infinity>()),
          .reference = 0.0,
          .tolerance = 1e-10,
          .note = "two linear oscillators with dashpots, 60 steps"});
}

/// Amplitude after `steps` steps of h over the first, X = 1 and V = 0.
double decay(double h, int steps) {
  System system = swing();
  Stepper stepper(system, ts_liealpha, Vector::Ones(1), Vector::Zero(1));
  stepper.run(steps, h * steps);
  return std::hypot(stepper.x()[0], stepper.v()[0]);
}

TEST(LieAlpha, RadiusOneKeepsTheEnergyOfALinearSystem) {
  const PetscOption option = radius(1);
  for (const double h : {0.1, 3.0, 1000.0}) {
    System system = swing();
    Stepper stepper(system, ts_liealpha, Vector::Ones(1), Vector::Zero(1));
    stepper.run(1000, 1000 * h);
    EXPECT_NEAR(stepper.x().squaredNorm() + stepper.v().squaredNorm(), 1, 1e-11) << "h " << h;
  }
}

TEST(LieAlpha, DampsUnresolvedFrequenciesByItsRadius) {
  for (const double rho : {0.8, 0.5, 0.2}) {
    const PetscOption option = radius(rho);
    const double h = 1e6;
    System system = swing();
    Stepper stepper(system, ts_liealpha, Vector::Ones(1), Vector::Zero(1));
    std::vector<double> x;
    system.accepted = [&](const Vector& at) { x.push_back(at[0]); };
    const int steps = 12;
    stepper.run(steps, steps * h);
    // A triple root -rho of the step: X_n+3 + 3 rho X_n+2 + 3 rho^2 X_n+1 + rho^3 X_n = 0.
    const double* last = x.data() + steps - 4;
    const std::array terms{last[3], 3 * rho * last[2], 3 * rho * rho * last[1],
                           rho * rho * rho * last[0]};
    double sum = 0, size = 0;
    for (const double term : terms) sum += term, size += std::abs(term);
    verify({.section = section_name,
            .quantity = text("far above resolution all roots of a step are -%g: what is left", rho),
            .value = sum / size,
            .reference = 0.0,
            .tolerance = 1e-6,
            .note = "omega h = 1e6"});
  }
  const PetscOption option = radius(0);
  // The first step's velocity is of the size h A0 = 1e6.
  EXPECT_LT(decay(1e6, 4), 1e-9 * 1e6);
}

TEST(LieAlpha, LeavesResolvedFrequenciesAlone) {
  for (const double rho : radii) {
    const PetscOption option = radius(rho);
    const int steps = 63;  // ten periods of a hundred steps would be 628
    EXPECT_GT(decay(0.1, steps), 0.99) << "radius " << rho;
  }
}

/// A body that tumbles freely: X the running sum of the rotation's increments in the body, q =
/// q_ref exp(X - X_ref), V the angular velocity in the body. (The equations do not know q.)
struct Top {
  Vector inertia = (Vector(3) << 1, 2, 2.9).finished();
  Quat<double> q{1, 0, 0, 0};
  Vector reference = Vector::Zero(3);
  System system;

  Top() {
    system.mass = inertia.asDiagonal();
    system.force = [this](double, const Vector&, const Vector& w) -> Vector {
      return -cross3(w, inertia.cwiseProduct(w));
    };
    system.slope = [this](double, const Vector&, const Vector& w) {
      return std::pair<Matrix, Matrix>(
          Matrix::Zero(3, 3),
          skew(inertia.cwiseProduct(w)) - skew(w) * Matrix(inertia.asDiagonal()));
    };
    system.accepted = [this](const Vector& x) {
      const Vector turn = x - reference;
      q = normalised(product(q, exp_rotation({turn[0], turn[1], turn[2]})));
      reference = x;
    };
  }
  Top(const Top&) = delete;
  Top& operator=(const Top&) = delete;
  static Vector cross3(const Vector& a, const Vector& b) { return skew(a) * b; }
  static Matrix skew(const Vector& a) {
    return (Matrix(3, 3) << 0, -a[2], a[1], a[2], 0, -a[0], -a[1], a[0], 0).finished();
  }
  Vec3<double> momentum(const Vector& w) const {
    return rotate(q, {inertia[0] * w[0], inertia[1] * w[1], inertia[2] * w[2]});
  }
};

const Vector top_spin = (Vector(3) << 0.35, 0.9, 0.25).finished();

TEST(LieAlpha, IsOfOrderTwoOnATumblingBody) {
  const double end = 12;  // tumbles over and turns by some 10 rad
  const auto at_end = [&](int steps) {
    Top top;
    Stepper stepper(top.system, ts_liealpha, Vector::Zero(3), top_spin);
    stepper.run(steps, end);
    Vector all(7);
    const double sign = top.q.w < 0 ? -1 : 1;
    all << sign * top.q.w, sign * top.q.x, sign * top.q.y, sign * top.q.z, stepper.v();
    return all;
  };
  for (const double rho : radii) {
    if (rho == 0.8 && !full_form()) continue;
    const PetscOption option = radius(rho);
    const Vector fine = at_end(full_form() ? 12800 : 6400);
    std::array<double, 3> error{};
    for (std::size_t k = 0; k < 3; ++k)
      error[k] = (at_end(200 << k) - fine).lpNorm<Eigen::Infinity>();
    for (std::size_t k = 0; k + 1 < 3; ++k)
      verify({.section = section_name,
              .quantity = text("tumbling body: order from %d and %d steps, radius %g", 200 << k,
                               400 << k, rho),
              .value = std::log2(error[k] / error[k + 1]),
              .reference = 2.0,
              .tolerance = 0.1,
              .note = "moments 1, 2, 2.9; rotation and angular velocity"});
  }
}

TEST(LieAlpha, GoesOnAsIfItHadNotStopped) {
  for (const double rho : radii) {
    const PetscOption option = radius(rho);
    System straight = oscillator(), first = oscillator(), second = oscillator();
    Stepper whole(straight, ts_liealpha, start_x, start_v);
    whole.run(40, 2);
    Stepper half(first, ts_liealpha, start_x, start_v);
    check(TSSetTimeStep(half.ts(), 0.05));
    half.run(20, 1);
    const LieAlphaHistory memory = liealpha_memory(half.ts());
    Stepper rest(second, ts_liealpha, half.x(), half.v());
    check(TSSetUp(rest.ts()));
    const LieAlphaHistory mine = liealpha_memory(rest.ts());
    check(VecCopy(memory.a, mine.a));
    check(VecCopy(memory.own, mine.own));
    double now = 0;
    check(TSGetTime(half.ts(), &now));
    check(TSSetTime(rest.ts(), now));
    check(TSSetStepNumber(rest.ts(), 20));
    resume_liealpha(rest.ts(), {mine.a, mine.own, memory.last_step, memory.delay});
    rest.run(20, 2);
    EXPECT_LT((rest.x() - whole.x()).lpNorm<Eigen::Infinity>(), 1e-13) << "radius " << rho;
    EXPECT_LT((rest.v() - whole.v()).lpNorm<Eigen::Infinity>(), 1e-13) << "radius " << rho;
  }
}

TEST(LieAlpha, StepsOfChangingLengthKeepTheOrder) {
  // Every step is 1.3 or 1/1.3 times the one before, in turn: without the correction of the own
  // acceleration each change costs an error of the second order, and the run is of the first.
  for (const double rho : {0.5, 0.0}) {
    const PetscOption option = radius(rho);
    const double end = 3;
    const auto at_end = [&](int pairs) {
      System system = oscillator();
      Stepper stepper(system, ts_liealpha, start_x, start_v);
      const double h = end / pairs / 2.3;
      int n = 0;
      system.accepted = [&](const Vector&) {
        ++n;
        check(TSSetTimeStep(stepper.ts(), n % 2 == 0 ? h : 1.3 * h));
      };
      check(TSSetTimeStep(stepper.ts(), h));
      check(TSSetMaxSteps(stepper.ts(), 2 * pairs));
      check(TSSetFromOptions(stepper.ts()));
      check(TSSolve(stepper.ts(), nullptr));
      Vector both(4);
      both << stepper.x(), stepper.v();
      return both;
    };
    const Vector fine = end_of(oscillator(), 12800, end);
    const double coarse = (at_end(100) - fine).lpNorm<Eigen::Infinity>(),
                 finer = (at_end(200) - fine).lpNorm<Eigen::Infinity>();
    verify({.section = section_name,
            .quantity = text("oscillator: order with steps in turn 1 and 1.3 long, radius %g", rho),
            .value = std::log2(coarse / finer),
            .reference = 2.0,
            .tolerance = 0.1});
  }
}

TEST(LieAlpha, AdaptsItsSteps) {
  // A slow motion, a jolt at t = 5, slow again.
  System system = swing();
  system.mass *= 100;
  system.force = [](double t, const Vector& x, const Vector&) -> Vector {
    return -x + Vector::Constant(1, 500 * std::exp(-50 * (t - 5) * (t - 5)));
  };
  const PetscOption adapt("-ts_adapt_type", "basic"), rtol("-ts_rtol", "1e-5"),
      atol("-ts_atol", "1e-5");
  Stepper stepper(system, ts_liealpha, Vector::Ones(1), Vector::Zero(1));
  check(TSSetTimeStep(stepper.ts(), 1e-3));
  check(TSSetMaxSteps(stepper.ts(), 100000));
  check(TSSetMaxTime(stepper.ts(), 20));
  check(TSSetFromOptions(stepper.ts()));
  check(TSSolve(stepper.ts(), nullptr));
  const auto [small, large] =
      std::minmax_element(stepper.steps_taken.begin() + 5, stepper.steps_taken.end());
  PetscInt rejected = 0;
  check(TSGetStepRejections(stepper.ts(), &rejected));
  EXPECT_GT(rejected, 0);
  EXPECT_GT(*large / *small, 5);
  double end = 0;
  check(TSGetTime(stepper.ts(), &end));
  // x = cos(t/10) + the jolt's impulse, spread over sigma = 0.1 s, as sin((t - 5)/10)/10.
  const double impulse = 5 * std::sqrt(std::numbers::pi / 50) * std::exp(-1.0 / (4 * 50 * 100));
  const double exact = std::cos(end / 10) + 10 * impulse * std::sin((end - 5) / 10);
  EXPECT_NEAR(stepper.x()[0], exact, 3e-3 * 12);
  EXPECT_LT(stepper.steps_taken.size(), 300U);
  std::size_t changes = 0;
  for (std::size_t k = 1; k < stepper.steps_taken.size(); ++k)
    changes += std::abs(stepper.steps_taken[k] / stepper.steps_taken[k - 1] - 1) > 1e-9 ? 1 : 0;
  EXPECT_LT(changes, stepper.steps_taken.size() / 2);
}

/// A failed Newton is repeated with a quarter of the step, from the state and rates as they were.
TEST(LieAlpha, ARejectedStepLeavesNothingBehind) {
  const PetscOption option = radius(0.5);
  System with = oscillator(), without = oscillator();
  const double h = 0.05;
  Stepper failing(with, ts_liealpha, start_x, start_v);
  check(TSSetMaxSNESFailures(failing.ts(), -1));
  with.accepted = [&](const Vector&) {
    if (failing.steps_taken.size() == 3) with.fail_at = with.function_calls + 3;
  };
  failing.run(5, 5 * h);
  ASSERT_EQ(failing.steps_taken.size(), 5U);
  EXPECT_NEAR(failing.steps_taken[3], h / 4, 1e-15);

  Stepper told(without, ts_liealpha, start_x, start_v);
  without.accepted = [&](const Vector&) {
    if (told.steps_taken.size() == 3) check(TSSetTimeStep(told.ts(), h / 4));
  };
  told.run(5, 5 * h);
  EXPECT_EQ(failing.x(), told.x());
  EXPECT_EQ(failing.v(), told.v());
}

TEST(LieAlpha, RefusesARadiusOutOfRange) {
  for (const char* value : {"-0.1", "1.1"}) {
    const PetscOption option("-ts_liealpha_radius", value);
    System system = swing();
    Stepper stepper(system, ts_liealpha, Vector::Ones(1), Vector::Zero(1));
    EXPECT_THROW(check(TSSetFromOptions(stepper.ts())), InputError) << value;
  }
}

}  // namespace
}  // namespace floe::test
