/// \file
/// Small systems M A = f(t, X, V) stepped by a TS for second-order equations.
#pragma once

#include <Eigen/Dense>

#include <cmath>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "floe/base/petsc.h"
#include "implicit/liealpha.h"

namespace floe::test {

using Vector = Eigen::VectorXd;
using Matrix = Eigen::MatrixXd;

/// M A = f(t, X, V) with a constant M, for either of the two types.
struct System {
  Matrix mass;
  std::function<Vector(double, const Vector&, const Vector&)> force;
  /// Derivatives of the force to X and V.
  std::function<std::pair<Matrix, Matrix>(double, const Vector&, const Vector&)> slope;
  /// Called with X after each accepted step.
  std::function<void(const Vector&)> accepted = [](const Vector&) {};
  int function_calls = 0;
  int fail_at = -1;  ///< this call of the function gives no number
};

inline Vector vector_of(Vec v) {
  PetscInt n = 0;
  check(VecGetSize(v, &n));
  const PetscScalar* values = nullptr;
  check(VecGetArrayRead(v, &values));
  Vector out = Eigen::Map<const Vector>(values, n);
  check(VecRestoreArrayRead(v, &values));
  return out;
}

inline void put(Vec v, const Vector& values) {
  PetscScalar* to = nullptr;
  check(VecGetArrayWrite(v, &to));
  Eigen::Map<Vector>(to, values.size()) = values;
  check(VecRestoreArrayWrite(v, &to));
}

/// x'' = -x: undamped, one degree of freedom, omega = 1.
inline System swing() {
  System s;
  s.mass = Matrix::Identity(1, 1);
  s.force = [](double, const Vector& x, const Vector&) -> Vector { return -x; };
  s.slope = [](double, const Vector&, const Vector&) {
    return std::pair<Matrix, Matrix>(-Matrix::Identity(1, 1), Matrix::Zero(1, 1));
  };
  return s;
}

/// A TS on a system, with X and V at t = 0.
class Stepper {
 public:
  Stepper(System& system, const char* type, const Vector& x, const Vector& v) : system_(system) {
    const auto n = static_cast<PetscInt>(x.size());
    check(VecCreateSeq(PETSC_COMM_SELF, n, x_.put()));
    check(VecDuplicate(x_, v_.put()));
    put(x_, x);
    put(v_, v);
    check(MatCreateSeqDense(PETSC_COMM_SELF, n, n, nullptr, matrix_.put()));
    check(TSCreate(PETSC_COMM_SELF, ts_.put()));
    register_liealpha();
    check(TSSetType(ts_, type));
    check(TS2SetSolution(ts_, x_, v_));
    check(TSSetI2Function(ts_, nullptr, function, this));
    check(TSSetI2Jacobian(ts_, matrix_, matrix_, jacobian, this));
    check(TSSetApplicationContext(ts_, this));
    check(TSSetPostStep(ts_, [](TS ts) noexcept {
      Stepper* me = nullptr;
      check(TSGetApplicationContext(ts, static_cast<void*>(&me)));
      me->after_step();
      return PetscErrorCode{0};
    }));
    problem_.start = [this](double t, Vec at, Vec rate, Vec a) {
      put(a, system_.mass.lu().solve(system_.force(t, vector_of(at), vector_of(rate))));
    };
    if (std::string(type) == ts_liealpha) set_liealpha_problem(ts_, &problem_);
    SNES snes = nullptr;
    KSP ksp = nullptr;
    PC pc = nullptr;
    check(TSGetSNES(ts_, &snes));
    SNESLineSearch search = nullptr;
    check(SNESGetLineSearch(snes, &search));
    check(SNESLineSearchSetType(search, SNESLINESEARCHBASIC));  // bt has a largest step
    check(SNESGetKSP(snes, &ksp));
    check(KSPSetType(ksp, KSPPREONLY));
    check(KSPGetPC(ksp, &pc));
    check(PCSetType(pc, PCLU));
    check(SNESSetTolerances(snes, 1e-60, 1e-14, 1e-14, 30, 1000));
    check(TSSetExactFinalTime(ts_, TS_EXACTFINALTIME_STEPOVER));
    check(TSSetMaxTime(ts_, 1e30));
    check(TSSetErrorIfStepFails(ts_, PETSC_FALSE));
  }
  Stepper(const Stepper&) = delete;
  Stepper& operator=(const Stepper&) = delete;

  /// To t = end from where it is.
  void run(int steps, double end) {
    PetscInt done = 0;
    double now = 0;
    check(TSGetStepNumber(ts_, &done));
    check(TSGetTime(ts_, &now));
    check(TSSetTimeStep(ts_, (end - now) / steps));
    check(TSSetMaxSteps(ts_, done + steps));
    check(TSSetFromOptions(ts_));
    check(TSSolve(ts_, nullptr));
  }

  TS ts() const { return ts_; }
  Vector x() const { return vector_of(x_); }
  Vector v() const { return vector_of(v_); }
  std::vector<double> steps_taken;

 private:
  void after_step() {
    double now = 0, before = 0;
    check(TSGetTime(ts_, &now));
    check(TSGetPrevTime(ts_, &before));
    steps_taken.push_back(now - before);
    system_.accepted(x());
  }
  static PetscErrorCode function(TS, PetscReal t, Vec x, Vec v, Vec a, Vec f, void* self) noexcept {
    System& s = static_cast<Stepper*>(self)->system_;
    put(f, s.mass * vector_of(a) - s.force(t, vector_of(x), vector_of(v)));
    if (s.function_calls++ == s.fail_at) check(VecSet(f, std::nan("")));
    return 0;
  }
  static PetscErrorCode jacobian(TS, PetscReal t, Vec x, Vec v, Vec, PetscReal by_v, PetscReal by_a,
                                 Mat j, Mat, void* self) noexcept {
    System& s = static_cast<Stepper*>(self)->system_;
    const auto [k, c] = s.slope(t, vector_of(x), vector_of(v));
    const Matrix all = by_a * s.mass - k - by_v * c;
    PetscScalar* to = nullptr;
    check(MatDenseGetArrayWrite(j, &to));
    Eigen::Map<Matrix>(to, all.rows(), all.cols()) = all;
    check(MatDenseRestoreArrayWrite(j, &to));
    check(MatAssemblyBegin(j, MAT_FINAL_ASSEMBLY));
    check(MatAssemblyEnd(j, MAT_FINAL_ASSEMBLY));
    return 0;
  }

  System& system_;
  Handle<Vec> x_, v_;
  Handle<Mat> matrix_;
  LieAlphaProblem problem_;
  Handle<TS> ts_;
};

}  // namespace floe::test
