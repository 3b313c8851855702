// Explicit dynamics by PETSc's TSRK, with bodies as vectors (FirstOrderSystem). After each accepted
// step quaternions are normalised, prescribed components are set to their exact values and
// integrals of powers are added to the works. That changes the solution, so TS evaluates the
// first stage anew even if the method could reuse its last one (TSPostStep compares the vector's
// state). A restart from a checkpoint is therefore the same to the last bit.
#include <petscts.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "base/format.h"
#include "explicit/explicit_run.h"
#include "explicit/first_order_system.h"
#include "run/dynamic_run.h"
#include "run/numbers.h"
#include "stability/rk_stability.h"

namespace floe {
namespace {

class RkRun final : public ExplicitRun<Spatial> {
 public:
  RkRun(Model<Spatial>& model, const ExplicitOptions& options, Observer<Spatial> observer)
      : ExplicitRun(TSRK, model, options, std::move(observer)), equations_(model) {
    check(VecCreateMPI(model.part().comm, static_cast<PetscInt>(equations_.size()), PETSC_DETERMINE,
                       solution_.put()));
    check(TSCreate(model.part().comm, ts_.put()));
    check(TSSetType(ts_, TSRK));
    check(TSSetSolution(ts_, solution_));
    check(TSSetRHSFunction(ts_, nullptr, right_hand_side, this));
    check(TSSetApplicationContext(ts_, this));
    check(TSSetPostStep(ts_, post_step));
    TSAdapt adapt = nullptr;
    check(TSGetAdapt(ts_, &adapt));
    check(TSAdaptSetType(adapt, TSADAPTNONE));
    read_options();
    read_types();
  }

  bool prepare() override {
    if (restart()) {
      equations_.go_on(state());
    } else {
      boundary_work_ = equations_.begin(state());
      choose_step();
    }
    if (!announce()) return false;
    if (is_adaptive()) {
      set_tolerances();
      limit_steps();
    }
    equations_.from_records(state(), *Numbers(solution_));
    check(TSRestartStep(ts_));  // or a method that reuses its last stage would do so at step n > 0
    return true;
  }

 private:
  void read_types();
  StabilityPolynomial polynomial() const;
  int evaluations_a_step() const override {
    PetscInt stages = 1;
    check(TSRKGetTableau(ts_, &stages, nullptr, nullptr, nullptr, nullptr, nullptr, nullptr,
                         nullptr));
    return stages;
  }
  void set_tolerances();
  void limit_steps();
  bool stepped();

  bool first() override { return evaluate_and_sample_if_due(); }
  Energies energies() const override {
    return {equations_.kinetic(state()), boundary_work_ + equations_.work_of_state(state())};
  }
  void persist_own(Archive& archive) override {
    ExplicitRun::persist_own(archive);
    archive.share("boundary_work", boundary_work_);
  }
  StableStep find_stable_step() override;
  std::vector<PetscObject> objects() const override { return {object_of(solution_.get())}; }
  void step_changed(double) override {
    if (is_adaptive()) limit_steps();
  }

  static RkRun& of(TS ts) {
    RkRun* run = nullptr;
    check(TSGetApplicationContext(ts, &run));
    return *run;
  }
  static PetscErrorCode right_hand_side(TS, PetscReal time, Vec y, Vec rates, void* self) noexcept {
    auto& run = *static_cast<RkRun*>(self);
    const double* numbers = nullptr;
    check(VecGetArrayRead(y, &numbers));
    run.equations_.to_records({numbers, run.equations_.size()}, time, run.state());
    check(VecRestoreArrayRead(y, &numbers));
    run.evaluate();
    run.equations_.rates(run.state(), run.wrenches(), *Numbers(rates));
    return 0;
  }
  static PetscErrorCode post_step(TS ts) noexcept {
    RkRun& run = of(ts);
    run.after_step([&] { return run.stepped(); });
    return 0;
  }

  FirstOrderSystem equations_;
  Handle<Vec> solution_;
  double boundary_work_ = 0;  ///< less the part that follows from the state [J]
};

/// Reads the method and the adaptivity that the command line chose. \throws InputError for those
/// that cannot step bodies
void RkRun::read_types() {
  TSRKType type = nullptr;
  check(TSRKGetType(ts_, &type));
  const PetscReal* embedded = nullptr;
  check(TSRKGetTableau(ts_, nullptr, nullptr, nullptr, nullptr, &embedded, nullptr, nullptr,
                       nullptr));
  TSAdapt adapt = nullptr;
  check(TSGetAdapt(ts_, &adapt));
  TSAdaptType chosen = nullptr;
  check(TSAdaptGetType(adapt, &chosen));
  const std::string adaptivity = chosen, rk = type;
  if (rk == TSRK1FE)
    throw InputError(
        "ts_rk_type: '1fe' cannot step this scene: it is Euler's method, which makes "
        "slow vibrations grow however they are damped");
  if (adaptivity != TSADAPTNONE && adaptivity != TSADAPTBASIC)
    throw InputError("ts_adapt_type: '" + adaptivity +
                     "' is not for bodies: must be none (a fixed step) or basic (from the error)");
  const bool adaptive = adaptivity == TSADAPTBASIC;
  // PETSc has no embedded method where bembed repeats b.
  if (adaptive && embedded == nullptr)
    throw InputError(
        "ts_adapt_type: 'basic' needs a method that estimates its error; ts_rk_type: '" + rk +
        "' has none (2a, 3bs, 5f, 5dp, 5bs, 6vr, 7vr and 8vr have)");
  set_adaptive(adaptive);
  result().stepper = "rk " + rk + (adaptive ? ", adaptive" : "");
}

StabilityPolynomial RkRun::polynomial() const {
  PetscInt stages = 0;
  const PetscReal *a = nullptr, *b = nullptr;
  check(TSRKGetTableau(ts_, &stages, &a, &b, nullptr, nullptr, nullptr, nullptr, nullptr));
  const auto s = static_cast<std::size_t>(stages);
  return {std::span(a, s * s), std::span(b, s)};
}

StableStep RkRun::find_stable_step() {
  model().part().ghosts.update(state().records, Spatial::record);
  StableStep stable = rk_stable_step(polynomial(), model(), state());
  // A step so far below the limit of the scene's rates means that the stability region leaves out
  // the imaginary axis, or nearly does.
  constexpr double useless = 0.2;
  const double fastest = std::max(stable.omega, stable.decay);
  if (done() == 0 && !explicit_options().allow_unstable && stable.dt * fastest < useless)
    throw InputError(
        "ts_rk_type: '" + result().stepper.substr(3) +
        "' makes vibrations grow that are not damped enough, whatever the step: its stability "
        "region leaves out the imaginary axis; take 3, 3bs, 4 or another, or damp the beams "
        "(limited by the " +
        stable.limit +
        "; time: allow_unstable: true with a dt takes it all "
        "the same)");
  return stable;
}

/// Sets the tolerances atol + rtol |y| of a step's error. As components have different units, atol
/// is scaled by the beams' mean length, a radian, and these per stable step.
void RkRun::set_tolerances() {
  PetscReal absolute = 0, relative = 0;
  check(TSGetTolerances(ts_, &absolute, nullptr, &relative, nullptr));
  Handle<Vec> atol, rtol;
  check(VecDuplicate(solution_, atol.put()));
  check(VecDuplicate(solution_, rtol.put()));
  const double time = std::isfinite(result().stable_dt) ? result().stable_dt : dt();
  const Part& part = model().part();
  {
    const Numbers a(atol), r(rtol);
    std::fill((*r).begin(), (*r).end(), relative);
    for (std::size_t b = 0; b < static_cast<std::size_t>(part.owned); ++b) {
      double* at = &(*a)[b * FirstOrderSystem::width];
      const Point3& inertia = part.bodies.inertia[b];
      const double moment = std::max({inertia.x, inertia.y, inertia.z});
      std::fill_n(at + FirstOrderSystem::displacement, 3, absolute * model().length_scale());
      std::fill_n(at + FirstOrderSystem::rotation, 4, absolute);
      std::fill_n(at + FirstOrderSystem::velocity, 3, absolute * model().length_scale() / time);
      std::fill_n(at + FirstOrderSystem::momentum, 3, absolute * moment / time);
    }
    // Integrals of power do not count: PETSc leaves out components without a tolerance.
    const auto works = static_cast<std::ptrdiff_t>(equations_.bodies_size());
    std::fill((*a).begin() + works, (*a).end(), 0.0);
    std::fill((*r).begin() + works, (*r).end(), 0.0);
  }
  check(TSSetTolerances(ts_, absolute, atol, relative, rtol));
}

/// Keeps adaptive steps below the stable one.
void RkRun::limit_steps() {
  if (!std::isfinite(result().stable_dt) || explicit_options().allow_unstable) return;
  TSAdapt adapt = nullptr;
  check(TSGetAdapt(ts_, &adapt));
  PetscReal most = 0;
  check(TSAdaptGetStepLimits(adapt, nullptr, &most));
  check(TSAdaptSetStepLimits(adapt, PETSC_DEFAULT,
                             std::min(most, explicit_options().safety * result().stable_dt)));
}

/// Work after an accepted step. False: the run ends here.
bool RkRun::stepped() {
  TSConvergedReason reason = TS_CONVERGED_ITERATING;
  check(TSGetConvergedReason(ts_, &reason));
  if (reason < 0) {
    give_up("steps are rejected again and again at time " + text(time()) +
            " s (limits: -ts_rtol, -ts_atol, -ts_max_reject)");
    return false;
  }
  double now = next_time();
  if (is_adaptive()) {
    double next = 0;
    check(TSGetTime(ts_, &now));
    check(TSGetTimeStep(ts_, &next));
    set_dt(next);
  } else {
    check(TSSetTime(ts_, now));  // roundings do not add up
  }
  {
    const Numbers numbers(solution_);
    equations_.to_records(*numbers, now, state());
    const double* work = &(*numbers)[equations_.bodies_size()];
    for (double& sum : work_ledger().all()) sum += *work++;
    boundary_work_ += *work;
    equations_.from_records(state(), *numbers);
  }
  if (!moved(now, equations_.largest_speed2(state()))) return false;
  // The run samples the last state itself.
  if (!is_last(reason) && !(evaluate_and_sample_if_due() && keep_step_stable())) return false;
  return look_around();
}

}  // namespace

std::unique_ptr<Run> make_rk_run(Model<Spatial>& model, const ExplicitOptions& options,
                                 Observer<Spatial> observer) {
  for (const auto& force : model.forces()) {
    if (force->roles().commits != nullptr)
      throw InputError("ts_type: 'rk' cannot step force '" + std::string(force->name()) +
                       "': it remembers what happened, and stages of a step have not happened "
                       "(integrator: explicit steps it with leapfrog)");
  }
  return std::make_unique<RkRun>(model, options, std::move(observer));
}

}  // namespace floe
