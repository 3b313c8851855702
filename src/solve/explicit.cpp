#include <cmath>

#include "solve/dynamic_run.h"
#include "solve/leapfrog.h"
#include "solve/motion.h"
#include "solve/stable_step.h"
#include "solve/text.h"
#include "solve/ts_options.h"

namespace floe {
namespace {

/// Leapfrog's run: velocities half a step behind positions.
class LeapfrogRun final : public DynamicRun<Spatial> {
 public:
  LeapfrogRun(Model<Spatial>& model, const ExplicitOptions& options,
              const Observer<Spatial>& observer)
      : DynamicRun("explicit", model, options, observer), options_(options), motion_(model) {
    motion_.start(state(), model.part().bodies.velocity, model.part().bodies.angular_velocity);
    evaluate();
  }

  /// Fixes the step: the given one, or from the stable step.
  void choose_step() {
    const double given = options().dt;
    const StableStep stable = stable_step(model(), state());
    evaluate();  // forces keep by-products of their last evaluation: the power they take
    result().stable_dt = stable.dt;
    result().limited_by = stable.limit;
    if (given > stable.dt && !options_.allow_unstable)
      throw InputError("time: dt: " + text(given) + " must be <= " + text(stable.dt) +
                       " [s], the stable step, limited by the " + stable.limit +
                       " (time: allow_unstable: true takes it all the same)");
    const double wanted = given > 0 ? given : options_.safety * stable.dt;
    if (!std::isfinite(wanted))
      throw InputError("time: dt: auto finds no force that limits the step; give one");
    plan(wanted);
    motion_.stagger(state(), wrenches(), dt());
    model().part().ghosts.update(state().records, Spatial::record);
  }

  /// The forces at t_n are known: samples that are due see them, then bodies move to t_n+1.
  bool step(double dt) {
    if (done() > 0) evaluate();
    if (!sample_if_due()) return false;
    const double speed2 = motion_.step(state(), wrenches(), dt);
    for (const auto& force : model().forces()) force->commit(state(), dt);
    return moved(static_cast<double>(done() + 1) * dt, speed2) && look_around();
  }

 private:
  Energies energies() const override {
    const auto [kinetic, boundary] = motion_.energies(state(), wrenches(), dt());
    return {kinetic, boundary};
  }
  void remember_own(Memory& memory) override {
    double work = motion_.boundary_work();
    memory.share("boundary_work", work);
    motion_.set_boundary_work(work);
  }

  const ExplicitOptions& options_;
  Motion motion_;
};

}  // namespace

RunResult run_explicit(Model<Spatial>& model, const ExplicitOptions& options,
                       const Observer<Spatial>& observer) {
  refuse_options_of_others();
  register_leapfrog();
  const StopSignals signals;
  LeapfrogRun run(model, options, observer);
  const Part& part = model.part();
  Handle<Vec> solution;
  check(VecCreateMPIWithArray(part.comm, Spatial::record, part.owned * Spatial::record,
                              PETSC_DETERMINE, run.state().records.data(), solution.put()));
  Handle<TS> ts;
  check(TSCreate(part.comm, ts.put()));
  check(TSSetType(ts, ts_leapfrog));
  check(TSSetSolution(ts, solution));
  run.read_options(ts);
  if (!run.restart()) run.choose_step();
  LeapfrogStep step = [&](double dt) { return run.guarded([&] { return run.step(dt); }); };
  set_leapfrog_step(ts, &step);
  return run.solve(ts);
}

}  // namespace floe
