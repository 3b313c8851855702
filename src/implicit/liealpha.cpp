#include "implicit/liealpha.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "run/ts_type.h"

namespace floe {
namespace {

constexpr double default_radius = 0.8;
constexpr double default_hold = 2;

struct Parameters {
  double alpha_m, alpha_f, gamma, beta;
};

Parameters parameters_of(double radius) {
  const double alpha_m = (2 * radius - 1) / (radius + 1), alpha_f = radius / (radius + 1);
  const double gamma = 0.5 + alpha_f - alpha_m;
  return {alpha_m, alpha_f, gamma, 0.25 * (gamma + 0.5) * (gamma + 0.5)};
}

/// Data of a TS of this type; PETSc allocates and zeroes them. Index 0: at t_n, 1: at t_n + h.
struct LieAlpha {
  const LieAlphaProblem* problem;
  double radius, hold;
  double h, last_step;
  bool resumed;
  std::int64_t iterations;
  Vec x0, v0, a0, own0;
  Vec x1, v1, a1, own1;
  Vec start;      ///< the method's own acceleration at t_n, scaled for the present h
  Vec increment;  ///< X1 - X0, the unknown: accelerations follow from it without cancellation
  Vec error;

  std::array<Vec*, 11> vectors() {
    return {&x0, &v0, &a0, &own0, &x1, &v1, &a1, &own1, &start, &increment, &error};
  }
};

LieAlpha& of(TS ts) { return *static_cast<LieAlpha*>(ts->data); }

/// Sets the stage at t_n + h from an increment.
PetscErrorCode put_stage(TS ts, Vec increment) {
  LieAlpha& me = of(ts);
  const auto [alpha_m, alpha_f, gamma, beta] = parameters_of(me.radius);
  const double h = me.h;
  PetscFunctionBegin;
  PetscCall(VecWAXPY(me.x1, 1.0, me.x0, increment));
  // own1 = (increment/h - V0)/(h beta) - (1/(2 beta) - 1) start
  PetscCall(VecCopy(increment, me.own1));
  PetscCall(
      VecAXPBYPCZ(me.own1, -1 / (h * beta), 1 - 0.5 / beta, 1 / (h * h * beta), me.v0, me.start));
  // V1 = V0 + h ((1 - gamma) start + gamma own1)
  PetscCall(VecCopy(me.v0, me.v1));
  PetscCall(VecAXPBYPCZ(me.v1, h * (1 - gamma), h * gamma, 1.0, me.start, me.own1));
  // A1 = ((1 - alpha_m) own1 + alpha_m start - alpha_f A0)/(1 - alpha_f)
  const double scale = 1 / (1 - alpha_f);
  PetscCall(VecCopy(me.own1, me.a1));
  PetscCall(VecAXPBYPCZ(me.a1, scale * alpha_m, -scale * alpha_f, scale * (1 - alpha_m), me.start,
                        me.a0));
  if (me.problem->prescribe) me.problem->prescribe(ts->ptime + h, {me.x1, me.v1, me.a1, me.own1});
  PetscFunctionReturn(0);
}

/// Sets the increment by_velocity * V0 and its stage; returns the norm of F there unless `norm` is
/// null.
PetscErrorCode try_increment(TS ts, double by_velocity, PetscReal* norm) {
  LieAlpha& me = of(ts);
  PetscFunctionBegin;
  PetscCall(VecCopy(me.v0, me.increment));
  PetscCall(VecScale(me.increment, by_velocity));
  PetscCall(put_stage(ts, me.increment));
  PetscCall(VecWAXPY(me.increment, -1.0, me.x0, me.x1));  // with prescribed components
  if (norm == nullptr) PetscFunctionReturn(0);
  PetscCall(TSComputeI2Function(ts, ts->ptime + me.h, me.x1, me.v1, me.a1, me.error));
  PetscCall(VecNorm(me.error, NORM_2, norm));
  PetscFunctionReturn(0);
}

/// Scales the own acceleration to this h: A + (own - A) h/h_last, as own - A is proportional to the
/// step. Chooses Newton's initial guess: X0 + h V0 or X0, the one with the smaller F. The first
/// suits smooth motions; where V has vibrations that h does not resolve, it is wrong by many times
/// the motion.
PetscErrorCode predict(TS ts) {
  LieAlpha& me = of(ts);
  const double h = me.h;
  PetscReal moving = 0, staying = 0;
  PetscFunctionBegin;
  PetscCall(VecCopy(me.own0, me.start));
  if (me.last_step > 0 && h != me.last_step)
    PetscCall(VecAXPBY(me.start, 1 - h / me.last_step, h / me.last_step, me.a0));
  PetscCall(try_increment(ts, h, &moving));
  PetscCall(try_increment(ts, 0, &staying));
  if (moving < staying) PetscCall(try_increment(ts, h, nullptr));
  PetscFunctionReturn(0);
}

PetscErrorCode begin_step(TS ts) {
  LieAlpha& me = of(ts);
  PetscFunctionBegin;
  PetscCheck(ts->vec_dot && me.problem, PetscObjectComm(reinterpret_cast<PetscObject>(ts)),
             PETSC_ERR_ARG_WRONGSTATE, "TS2SetSolution() and the problem must be set");
  PetscCall(VecCopy(ts->vec_sol, me.x0));
  PetscCall(VecCopy(ts->vec_dot, me.v0));
  if (ts->steprestart && !me.resumed) {
    me.problem->start(ts->ptime, me.x0, me.v0, me.a0);
    PetscCall(VecCopy(me.a0, me.own0));
    me.last_step = 0;
  }
  me.resumed = false;
  PetscFunctionReturn(0);
}

PetscErrorCode solve_stage(TS ts, PetscBool* good) {
  LieAlpha& me = of(ts);
  PetscInt newton = 0, linear = 0;
  PetscFunctionBegin;
  me.h = ts->time_step;
  const double time = ts->ptime + me.h;
  PetscCall(predict(ts));
  PetscCall(TSPreStage(ts, time));
  PetscCall(SNESSolve(ts->snes, nullptr, me.increment));
  PetscCall(SNESGetIterationNumber(ts->snes, &newton));
  PetscCall(SNESGetLinearSolveIterations(ts->snes, &linear));
  me.iterations += newton;
  constexpr PetscInt most = std::numeric_limits<PetscInt>::max();
  ts->snes_its += std::min(newton, most - ts->snes_its);
  ts->ksp_its += std::min(linear, most - ts->ksp_its);
  PetscCall(
      put_stage(ts, me.increment));  // a line search may have evaluated another increment last
  PetscCall(TSPostStage(ts, time, 0, &me.x1));
  PetscCall(TSAdaptCheckStage(ts->adapt, ts, time, me.x1, good));
  PetscFunctionReturn(0);
}

PetscErrorCode step(TS ts) noexcept {
  LieAlpha& me = of(ts);
  PetscFunctionBegin;
  PetscCall(begin_step(ts));
  PetscInt rejections = 0;
  PetscBool accept = PETSC_TRUE;  // TSAdapt shortens more after a failure
  while (ts->reason == TS_CONVERGED_ITERATING) {
    PetscBool good = PETSC_FALSE;
    PetscReal next = ts->time_step;
    PetscCall(solve_stage(ts, &good));
    if (good) {
      PetscCall(TSAdaptChoose(ts->adapt, ts, me.h, nullptr, &next, &accept));
      if (accept) {
        PetscCall(VecCopy(me.x1, ts->vec_sol));
        PetscCall(VecCopy(me.v1, ts->vec_dot));
        std::swap(me.a0, me.a1);
        std::swap(me.own0, me.own1);
        me.last_step = me.h;
        ts->ptime += me.h;
        // TSAdapt proposes at least 0.9 of an accepted step. Each change of the step needs another
        // matrix.
        const bool stays = next >= 0.89 * me.h && next < me.hold * me.h;
        ts->time_step = stays ? me.h : next;
        PetscFunctionReturn(0);
      }
      ts->time_step = next;
    }
    accept = PETSC_FALSE;
    ++ts->reject;
    if (ts->reason == TS_CONVERGED_ITERATING && ts->max_reject >= 0 &&
        ++rejections > ts->max_reject)
      ts->reason = TS_DIVERGED_STEP_REJECTED;
  }
  PetscFunctionReturn(0);
}

/// Local error of X: (beta + (alpha_m - alpha_f)/2 - 1/6) h^2 (a1 - a0), of third order, since own
/// accelerations lead A by (alpha_m - alpha_f) h. The norm of the whole error is compared with that
/// of X, so that the noise of a bent sheet's other unknowns does not count beside its deflection.
PetscErrorCode local_error(TS ts, NormType norm, PetscInt* order, PetscReal* weighted) noexcept {
  LieAlpha& me = of(ts);
  const auto [alpha_m, alpha_f, gamma, beta] = parameters_of(me.radius);
  PetscReal error = 0, before = 0, after = 0, expected = 0;
  PetscInt size = 1;
  PetscFunctionBegin;
  PetscCall(VecWAXPY(me.error, -1.0, me.start, me.own1));
  PetscCall(VecNorm(me.error, norm, &error));
  PetscCall(VecNorm(me.x0, norm, &before));
  PetscCall(VecNorm(me.x1, norm, &after));
  if (me.problem->expected != nullptr) PetscCall(VecNorm(me.problem->expected, norm, &expected));
  PetscCall(VecGetSize(me.x1, &size));
  const double mean = norm == NORM_2 ? 1 / std::sqrt(static_cast<double>(size)) : 1.0;
  error *= (beta + 0.5 * (alpha_m - alpha_f) - 1.0 / 6) * me.h * me.h * mean;
  *weighted = error / (ts->atol + ts->rtol * mean * std::max({before, after, expected}));
  *order = 3;
  PetscFunctionReturn(0);
}

PetscErrorCode form_function(SNES, Vec increment, Vec f, TS ts) noexcept {
  LieAlpha& me = of(ts);
  PetscFunctionBegin;
  PetscCall(put_stage(ts, increment));
  PetscCall(TSComputeI2Function(ts, ts->ptime + me.h, me.x1, me.v1, me.a1, f));
  PetscFunctionReturn(0);
}

PetscErrorCode form_jacobian(SNES, Vec, Mat j, Mat p, TS ts) noexcept {
  LieAlpha& me = of(ts);
  const auto [alpha_m, alpha_f, gamma, beta] = parameters_of(me.radius);
  const double h = me.h;
  PetscFunctionBegin;
  PetscCall(TSComputeI2Jacobian(ts, ts->ptime + h, me.x1, me.v1, me.a1, gamma / (h * beta),
                                (1 - alpha_m) / ((1 - alpha_f) * h * h * beta), j, p));
  PetscFunctionReturn(0);
}

PetscErrorCode set_up(TS ts) noexcept {
  PetscFunctionBegin;
  for (Vec* v : of(ts).vectors()) {
    if (*v == nullptr) PetscCall(VecDuplicate(ts->vec_sol, v));
  }
  SNES snes = nullptr;
  PetscCall(TSGetSNES(ts, &snes));
  PetscFunctionReturn(0);
}

PetscErrorCode reset(TS ts) noexcept {
  PetscFunctionBegin;
  for (Vec* v : of(ts).vectors()) PetscCall(VecDestroy(v));
  PetscFunctionReturn(0);
}

PetscErrorCode destroy(TS ts) noexcept {
  PetscFunctionBegin;
  PetscCall(reset(ts));
  PetscCall(PetscFree(ts->data));
  PetscFunctionReturn(0);
}

PetscErrorCode set_from_options(TS ts, TsOptionItems PetscOptionsObject) noexcept {
  LieAlpha& me = of(ts);
  PetscFunctionBegin;
  PetscOptionsHeadBegin(PetscOptionsObject, "Generalised-alpha method on the rotation group");
  PetscCall(PetscOptionsReal("-ts_liealpha_radius",
                             "Spectral radius for frequencies that the step does not resolve", "",
                             me.radius, &me.radius, nullptr));
  PetscCall(PetscOptionsReal("-ts_liealpha_hold",
                             "A step that could grow by less than this factor stays", "", me.hold,
                             &me.hold, nullptr));
  PetscOptionsHeadEnd();
  const MPI_Comm comm = PetscObjectComm(reinterpret_cast<PetscObject>(ts));
  PetscCheck(me.radius >= 0 && me.radius <= 1, comm, PETSC_ERR_USER_INPUT,
             "ts_liealpha_radius: %g must be in [0, 1]", me.radius);
  PetscCheck(me.hold >= 1, comm, PETSC_ERR_USER_INPUT, "ts_liealpha_hold: %g must be >= 1",
             me.hold);
  PetscFunctionReturn(0);
}

PetscErrorCode view(TS ts, PetscViewer viewer) noexcept {
  const LieAlpha& me = of(ts);
  const auto [alpha_m, alpha_f, gamma, beta] = parameters_of(me.radius);
  PetscBool ascii = PETSC_FALSE;
  PetscFunctionBegin;
  PetscCall(
      PetscObjectTypeCompare(reinterpret_cast<PetscObject>(viewer), PETSCVIEWERASCII, &ascii));
  if (!ascii) PetscFunctionReturn(0);
  PetscCall(PetscViewerASCIIPrintf(viewer,
                                   "  radius=%g, alpha_m=%g, alpha_f=%g, gamma=%g, beta=%g\n",
                                   me.radius, alpha_m, alpha_f, gamma, beta));
  PetscCall(PetscViewerASCIIPrintf(viewer, "  steps grow by at least the factor %g\n", me.hold));
  PetscFunctionReturn(0);
}

PetscErrorCode create(TS ts) noexcept {
  LieAlpha* me = nullptr;
  PetscFunctionBegin;
  PetscCall(PetscNew(&me));
  me->radius = default_radius;
  me->hold = default_hold;
  ts->data = static_cast<void*>(me);
  ts->ops->setup = set_up;
  ts->ops->step = step;
  ts->ops->evaluatewlte = local_error;
  ts->ops->snesfunction = form_function;
  ts->ops->snesjacobian = form_jacobian;
  ts->ops->reset = reset;
  ts->ops->destroy = destroy;
  ts->ops->setfromoptions = set_from_options;
  ts->ops->view = view;
  ts->default_adapt_type = TSADAPTNONE;
  ts->usessnes = PETSC_TRUE;
  PetscFunctionReturn(0);
}

}  // namespace

void register_liealpha() {
  static const bool once = [] {
    check(TSInitializePackage());
    check(TSRegister(ts_liealpha, create));
    return true;
  }();
  (void)once;
}

void set_liealpha_problem(TS ts, const LieAlphaProblem* problem) { of(ts).problem = problem; }

LieAlphaHistory liealpha_memory(TS ts) {
  const LieAlpha& me = of(ts);
  return {me.a0, me.own0, me.last_step, ts->adapt->timestepjustdecreased};
}

std::int64_t liealpha_iterations(TS ts) { return of(ts).iterations; }

std::vector<Vec> liealpha_vectors(TS ts) {
  std::vector<Vec> all;
  for (Vec* v : of(ts).vectors()) all.push_back(*v);
  return all;
}

void resume_liealpha(TS ts, const LieAlphaHistory& memory) {
  LieAlpha& me = of(ts);
  me.last_step = memory.last_step;
  ts->adapt->timestepjustdecreased = memory.delay;
  me.resumed = true;
}

}  // namespace floe
