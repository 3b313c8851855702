// Implicit dynamics by the TS type liealpha: callbacks of PETSc, reuse of factorisations, energies
// of a step, ends of steps.
#include "implicit/implicit.h"
#include "base/collectives.h"

#include <petscts.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "base/format.h"
#include "implicit/implicit_ts_options.h"
#include "implicit/liealpha.h"
#include "implicit/second_order_system.h"
#include "implicit/step_plan.h"
#include "model/newton.h"
#include "run/dynamic_run.h"
#include "run/expected_cost.h"
#include "run/numbers.h"

namespace floe {
namespace {

template <class Space>
class ImplicitRun final : public DynamicRun<Space> {
  using Base = DynamicRun<Space>;
  using Equations = SecondOrderSystem<Space>;
  using Base::done, Base::dt, Base::give_up, Base::model, Base::options, Base::result, Base::set_dt,
      Base::state, Base::ts_, Base::wrenches;

 public:
  ImplicitRun(Model<Space>& the_model, const DynamicOptions& given, Observer<Space> observer)
      : Base("implicit", ts_liealpha, the_model, given, std::move(observer)),
        equations_(the_model, this->state()),
        plan_(Base::options(), the_model.changes(Base::options().end)) {
    for (Handle<Vec>* v : {&x_, &v_, &x_before_, &v_before_, &expected_})
      *v = equations_.make_vector();
    equations_.begin(x_, v_);
    problem_.expected = expected_;
    problem_.start = [this](double t, Vec x, Vec v, Vec a) { equations_.acceleration(t, x, v, a); };
    if (!model().boundaries().empty())  // on some rank, perhaps not on this one
      problem_.prescribe = [this](double t, const LieAlphaStage& s) { equations_.prescribe(t, s); };
    set_up_ts();
    set_up_newton();
    this->read_options();
    read_types();
  }

  bool prepare() override {
    check(TSSetUp(ts_));
    const double first = plan_.begin(fixed_, options().dt);
    if (fixed_) this->require_few_steps(options().end / first, first);
    if (!this->restart()) this->plan(first);
    if (!this->announce()) return false;
    land();
    return true;
  }

 private:
  void set_up_ts();
  void set_up_newton();
  void read_types();
  void expect_motion();
  bool first() override;
  bool stepped();
  void keep_books();
  void land();
  std::string failure(TSConvergedReason reason) const;

  typename Base::Energies energies() const override { return {kinetic_, boundary_work_}; }
  Columns own_columns() const override {
    Columns columns;
    columns.add("energy_numerical", numerical_loss_);
    return columns;
  }
  void add_to(RunPlan& plan) const override {
    plan.adaptive = !fixed_;
    if (fixed_) plan.steps = std::ceil(plan.end / plan_.given() * (1 - 1e-12));
    plan.bytes = cost_.bytes;
    const Part& part = model().part();
    if (!is_like_a_sheet(static_cast<double>(part.global_bodies),
                         static_cast<double>(part.global_beams)))
      return;
    // A step takes two iterations, and a factorisation now and then.
    plan.seconds_a_step = 3 * cost_.solve_seconds + 0.2 * cost_.seconds;
    plan.measured = sheets_like_it;
  }
  void announce_factorisation() {
    this->announce_work("factorising " + text(unknowns_) + " unknowns", cost_.seconds);
  }
  void persist_own(Archive& archive) override;
  std::vector<PetscObject> objects() const override;

  static ImplicitRun& of(TS ts) {
    ImplicitRun* run = nullptr;
    check(TSGetApplicationContext(ts, &run));
    return *run;
  }
  static PetscErrorCode function(TS, PetscReal t, Vec x, Vec v, Vec a, Vec f, void* self) noexcept {
    static_cast<ImplicitRun*>(self)->equations_.residual(t, x, v, a, f);
    return 0;
  }
  static PetscErrorCode jacobian(TS, PetscReal t, Vec x, Vec v, Vec a, PetscReal by_v,
                                 PetscReal by_a, Mat, Mat, void* self) noexcept {
    auto& run = *static_cast<ImplicitRun*>(self);
    SNES snes = nullptr;
    KSP ksp = nullptr;
    check(TSGetSNES(run.ts_, &snes));
    check(SNESGetKSP(snes, &ksp));
    if (!drop_failed_factor(ksp) && run.keeps_factorisation(by_a)) return 0;
    run.equations_.assemble(t, x, v, a, by_v, by_a);
    run.announce_factorisation();
    return 0;
  }
  static PetscErrorCode converged(SNES, PetscInt it, PetscReal, PetscReal, PetscReal norm,
                                  SNESConvergedReason* reason, void* self) noexcept;
  static PetscErrorCode post_step(TS ts) noexcept {
    ImplicitRun& run = of(ts);
    run.after_step([&] { return run.stepped(); });
    return 0;
  }
  static PetscErrorCode in_domain(TS ts, PetscReal, Vec, PetscBool* good) noexcept;

  /// Whether to keep the factorisation, since a new one costs a dozen solves: it is kept, over
  /// steps, while the step is the same and each iteration takes a digit off the residual.
  bool keeps_factorisation(double by_acceleration) const {
    constexpr double a_digit = 0.1, same = 1e-6;
    const double last = equations_.by_acceleration();
    return adaptive_ && last > 0 && std::abs(by_acceleration / last - 1) < same &&
           contraction_ <= a_digit;
  }

  Equations equations_;
  LieAlphaProblem problem_;
  StepPlan plan_;
  const double unknowns_ = static_cast<double>(this->model().part().global_bodies) * Equations::n;
  const FactorisationCost cost_ = factorisation_cost(unknowns_, size(this->model().part().comm));
  Handle<Vec> x_, v_, x_before_, v_before_, expected_;
  bool adaptive_ =
      true;             // whether this class decides on factorisations (not if the user set a lag)
  bool fixed_ = false;  // whether the step is fixed
  double last_norm_ = 0,
         contraction_ =
             0;  // norm of the residual [N], and its ratio to that of the iteration before
  typename Equations::Forces forces_, forces_before_;
  State<Space> before_;                                          // at the last accepted step
  double kinetic_ = 0, boundary_work_ = 0, numerical_loss_ = 0;  // of this rank [J]
  std::int64_t newton_before_ = 0;                               // iterations before the restart
};

template <class Space>
void ImplicitRun<Space>::set_up_ts() {
  register_liealpha();
  check(TSCreate(model().part().comm, ts_.put()));
  check(TSSetType(ts_, ts_liealpha));
  set_liealpha_problem(ts_, &problem_);
  check(TS2SetSolution(ts_, x_, v_));
  check(TSSetI2Function(ts_, nullptr, function, this));
  check(TSSetI2Jacobian(ts_, equations_.matrix(), equations_.matrix(), jacobian, this));
  check(TSSetApplicationContext(ts_, this));
  check(TSSetPostStep(ts_, post_step));
  check(TSSetFunctionDomainError(ts_, in_domain));
  check(TSSetMaxSNESFailures(ts_, -1));  // the step is cut; -ts_max_reject limits how often
  // Tolerances of a step's error, rms over all unknowns: relative to the motion (the expected one
  // at least), and absolute in beam lengths. The absolute one is at the level of rounding, or small
  // loads would have no effect on steps.
  check(TSSetTolerances(ts_, 1e-13 * model().length_scale(), nullptr, 1e-3, nullptr));
  TSAdapt adapt = nullptr;
  check(TSGetAdapt(ts_, &adapt));
  check(TSAdaptSetType(adapt, options().dt > 0 ? TSADAPTNONE : TSADAPTBASIC));
}

/// Sets defaults that PETSc's own options override.
template <class Space>
void ImplicitRun<Space>::set_up_newton() {
  SNES snes = nullptr;
  check(TSGetSNES(ts_, &snes));
  set_newton_defaults(snes);
  check(SNESSetTolerances(snes, 0.0, 1e-5, 0.0, 25, PETSC_DEFAULT));
  check(SNESSetConvergenceTest(snes, converged, this, nullptr));
  PetscBool lag_given = PETSC_FALSE;
  check(PetscOptionsHasName(nullptr, nullptr, "-snes_lag_jacobian", &lag_given));
  adaptive_ = lag_given == PETSC_FALSE;
}

template <class Space>
void ImplicitRun<Space>::read_types() {
  TSAdapt adapt = nullptr;
  TSAdaptType type = nullptr;
  check(TSGetAdapt(ts_, &adapt));
  check(TSAdaptGetType(adapt, &type));
  const std::string name = type;
  if (name != TSADAPTNONE && name != TSADAPTBASIC)
    throw InputError("ts_adapt_type: '" + name +
                     "' is not for bodies: must be none (a fixed step) or basic (from the error)");
  fixed_ = name == TSADAPTNONE;
  if (fixed_ && !(options().dt > 0) && options().checkpoint.restart.empty())
    throw InputError("ts_adapt_type: none needs a step: give time: dt");
  this->set_adaptive(
      true);  // a step can be cut in any case: time ends the run, not the number of steps
}

/// Computes the motion to which errors are relative while loads and boundaries rise slowly:
/// relative to the motion so far, which is almost zero, steps would be tiny. The motion over the
/// longest ramp counts instead: boundaries at the ramp's end, and the displacements of one linear
/// step with the loads' full forces.
template <class Space>
void ImplicitRun<Space>::expect_motion() {
  const std::vector<double> ramps = model().changes(options().end);
  if (ramps.empty()) return;
  const double span = std::min(ramps.back(), options().end);
  const Handle<Vec> zero = equations_.make_vector(), force = equations_.make_vector(),
                    ignored = equations_.make_vector();
  const double by_velocity = 2 / span, by_acceleration = 4 / (span * span);  // trapezoidal rule
  equations_.residual(span, x_, zero, zero, force);
  equations_.assemble(span, x_, zero, zero, by_velocity, by_acceleration);
  announce_factorisation();
  SNES snes = nullptr;
  KSP ksp = nullptr;
  check(TSGetSNES(ts_, &snes));
  check(SNESGetKSP(snes, &ksp));
  check(KSPSetOperators(ksp, equations_.matrix(), equations_.matrix()));
  check(KSPSolve(ksp, force, expected_));
  check(VecScale(expected_, -1));
  equations_.prescribe(span, {expected_, ignored, ignored, ignored});
  equations_.take(0, x_, v_);
}

template <class Space>
bool ImplicitRun<Space>::first() {
  constexpr double rounding = 1e-12;  // of the sum of steps
  check(TSSetMaxTime(ts_, (1 - rounding) * options().end));
  check(TSSetExactFinalTime(
      ts_, TS_EXACTFINALTIME_STEPOVER));  // land() makes steps end at the run's end
  const LieAlphaHistory memory = liealpha_memory(ts_);
  if (done() == 0) {
    if (!fixed_) expect_motion();
    equations_.acceleration(state().time, x_, v_, memory.a);
  }
  equations_.rebase(x_);
  this->evaluate();
  equations_.forces(v_, memory.a, wrenches(), forces_before_);
  kinetic_ = equations_.kinetic(v_);
  before_ = state();
  check(VecCopy(x_, x_before_));
  check(VecCopy(v_, v_before_));
  return this->sample_if_due();
}

/// Computes the energies of a step by the trapezoidal rule, which the method of radius 1 conserves
/// in a linear system: the inertia forces g of the bodies do the work sum (g_0 + g_1).dX/2, which
/// is the work of forces and boundaries. The part of it that is not in the kinetic energy is the
/// method's numerical loss.
template <class Space>
void ImplicitRun<Space>::keep_books() {
  const LieAlphaHistory memory = liealpha_memory(ts_);
  equations_.forces(v_, memory.a, wrenches(), forces_);
  const ReadNumbers x(x_), x_before(x_before_), v(v_), v_before(v_before_);
  const auto work = [&](const std::vector<double>& before, const std::vector<double>& now) {
    double sum = 0;
    for (std::size_t k = 0; k < now.size(); ++k)
      sum += 0.5 * (before[k] + now[k]) * ((*x)[k] - (*x_before)[k]);
    return sum;
  };
  const double kinetic = equations_.kinetic(v_);
  numerical_loss_ += work(forces_before_.inertia, forces_.inertia) - (kinetic - kinetic_);
  boundary_work_ += work(forces_before_.reaction, forces_.reaction);
  kinetic_ = kinetic;
  // Where a prescribed velocity jumps, the boundary does the work for the kinetic energy.
  for (const std::size_t k : equations_.held()) {
    if (!equations_.is_displacement(k)) continue;
    const double now = (*v)[k], before = (*v_before)[k];
    const double share =
        0.5 * equations_.mass_of(k) * (now * now - before * before) -
        0.5 * (forces_before_.inertia[k] + forces_.inertia[k]) * ((*x)[k] - (*x_before)[k]);
    boundary_work_ += share;
    numerical_loss_ += share;
  }
  for (std::size_t k = 0; k < forces_.losses.size(); ++k) {
    const std::span<double> works = this->work_ledger().of(k);
    if (works.empty()) continue;
    if (forces_.losses[k].empty()) {
      model().forces()[k]->roles().work->add_works(before_, state(), works);
    } else {
      works.front() += work(forces_before_.losses[k], forces_.losses[k]);
    }
  }
  std::swap(forces_, forces_before_);
  before_ = state();
}

/// Work after an accepted step: energies, samples, the next step. False: the run ends here.
template <class Space>
bool ImplicitRun<Space>::stepped() {
  TSConvergedReason reason = TS_CONVERGED_ITERATING;
  check(TSGetConvergedReason(ts_, &reason));
  result().newton_iterations = newton_before_ + liealpha_iterations(ts_);
  if (reason < 0) {
    give_up(failure(reason));
    return false;
  }
  double now = 0, before = 0;
  check(TSGetTime(ts_, &now));
  check(TSGetPrevTime(ts_, &before));
  const double h = now - before;
  equations_.take(now, x_, v_);
  this->evaluate();
  keep_books();
  equations_.rebase(x_);
  check(VecCopy(x_, x_before_));
  check(VecCopy(v_, v_before_));
  result().dt = h;
  if (!this->moved(now, equations_.largest_speed2())) return false;
  // The run samples the last state itself.
  if (!this->is_last(reason) && !this->sample_if_due()) return false;
  double allowed = 0;
  check(TSGetTimeStep(ts_, &allowed));
  plan_.made(h, allowed);
  if (plan_.is_hopeless()) {
    give_up("Newton wants ever smaller steps: " + text(plan_.planned()) + " s at time " +
            text(now) + " s, where " + text(plan_.given()) + " s was given");
    return false;
  }
  land();
  return this->look_around();
}

template <class Space>
std::string ImplicitRun<Space>::failure(TSConvergedReason) const {
  SNES snes = nullptr;
  SNESConvergedReason why = SNES_CONVERGED_ITERATING;
  double step = 0;
  check(TSGetSNES(ts_, &snes));
  check(SNESGetConvergedReason(snes, &why));
  check(TSGetTimeStep(ts_, &step));
  if (why < 0) {
    KSP ksp = nullptr;
    check(SNESGetKSP(snes, &ksp));
    require_memory(ksp);
  }
  return "no step from time " + text(state().time) + " s on (cut to " + text(step) + " s): " +
         (why < 0 ? std::string("Newton failed (") + SNESConvergedReasons[why] + ")"
                  : "its error stays too large, or beams fold over") +
         " (limits: -ts_max_reject, -ts_rtol, -ts_atol, -snes_max_it)";
}

template <class Space>
void ImplicitRun<Space>::land() {
  const double next = plan_.next(state().time);
  set_dt(next);
  check(TSSetTimeStep(ts_, next));
}

template <class Space>
PetscErrorCode ImplicitRun<Space>::converged(SNES snes, PetscInt it, PetscReal, PetscReal,
                                             PetscReal norm, SNESConvergedReason* reason,
                                             void* self) noexcept {
  auto& run = *static_cast<ImplicitRun*>(self);
  run.contraction_ = it > 0 && run.last_norm_ > 0 ? norm / run.last_norm_ : 0.0;
  run.last_norm_ = norm;
  run.audit("Newton's method");
  run.show("Newton's iteration " + std::to_string(it));
  PetscReal atol = 0, rtol = 0;
  check(SNESGetTolerances(snes, &atol, &rtol, nullptr, nullptr, nullptr));
  *reason = SNES_CONVERGED_ITERATING;
  if (!std::isfinite(norm)) {
    *reason = SNES_DIVERGED_FUNCTION_DOMAIN;
    return 0;
  }
  // Never accept the initial guess by tolerance alone, or small forces would never act.
  const double tolerance = run.equations_.tolerance(it > 0 ? rtol : 0.0, it > 0 ? atol : 0.0);
  if (norm <= tolerance) *reason = SNES_CONVERGED_FNORM_RELATIVE;
  return 0;
}

/// Refuses a state in which beams have folded over: it is no solution (model.md, "Static
/// solution").
template <class Space>
PetscErrorCode ImplicitRun<Space>::in_domain(TS ts, PetscReal, Vec, PetscBool* good) noexcept {
  ImplicitRun& run = of(ts);
  std::int64_t folded = 0;
  if (run.model().beams() != nullptr) folded = run.model().beams()->folded(run.state());
  *good = on_any_rank(folded > 0, run.model().part().comm) ? PETSC_FALSE : PETSC_TRUE;
  return 0;
}

template <class Space>
std::vector<PetscObject> ImplicitRun<Space>::objects() const {
  SNES snes = nullptr;
  Vec residual = nullptr, update = nullptr;
  check(TSGetSNES(ts_, &snes));
  check(SNESGetFunction(snes, &residual, nullptr, nullptr));
  check(SNESGetSolutionUpdate(snes, &update));
  std::vector<PetscObject> all{object_of(equations_.matrix())};
  for (const Vec v : liealpha_vectors(ts_)) all.push_back(object_of(v));
  for (const Vec v :
       {x_.get(), v_.get(), x_before_.get(), v_before_.get(), expected_.get(), residual, update})
    all.push_back(object_of(v));
  return all;
}

template <class Space>
void ImplicitRun<Space>::persist_own(Archive& archive) {
  plan_.persist(archive);
  std::int64_t newton = result().newton_iterations;
  archive.common("newton_iterations", newton);
  archive.share("boundary_work", boundary_work_);
  archive.share("numerical_loss", numerical_loss_);
  LieAlphaHistory own = liealpha_memory(ts_);
  std::int64_t delay = own.delay;
  archive.common("last_step", own.last_step, not_negative);
  archive.common("delay", delay);
  const Part& part = model().part();
  persist(archive, part, "x", x_, Equations::n);
  persist(archive, part, "v", v_, Equations::n);
  persist(archive, part, "a", own.a, Equations::n);
  persist(archive, part, "own_a", own.own, Equations::n);
  persist(archive, part, "expected", expected_, Equations::n);
  equations_.persist(archive);
  if (!archive.loading()) return;
  newton_before_ = result().newton_iterations = newton;
  own.delay = static_cast<PetscInt>(delay);
  resume_liealpha(ts_, own);
}

}  // namespace

std::unique_ptr<Run> make_implicit_run(Model<Spatial>& model, const DynamicOptions& options,
                                       Observer<Spatial> observer) {
  for (const auto& force : model.forces()) {
    if (force->roles().commits != nullptr)
      throw InputError("integrator: implicit cannot step force '" + std::string(force->name()) +
                       "': it remembers what happened, and Newton's trials have not happened "
                       "(integrator: explicit steps it)");
  }
  check_implicit_options();
  return std::make_unique<ImplicitRun<Spatial>>(model, options, std::move(observer));
}

}  // namespace floe
