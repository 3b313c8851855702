#include "floe/forces/contact.h"
#include "floe/forces/fracture.h"
#include "solve/explicit_run.h"
#include "solve/leapfrog.h"
#include "solve/motion.h"
#include "solve/stable_step.h"
#include "solve/ts_options.h"

namespace floe {
namespace {

/// Leapfrog's run: velocities half a step behind positions.
class LeapfrogRun final : public ExplicitRun {
 public:
  LeapfrogRun(Model<Spatial>& model, const ExplicitOptions& options,
              const Observer<Spatial>& observer)
      : ExplicitRun(ts_leapfrog, model, options, observer), motion_(model) {
    result().stepper = ts_leapfrog;
    for (const auto& force : model.forces()) {
      if (auto* contact = dynamic_cast<Contact*>(force.get())) contact_ = contact;
    }
    motion_.start(state(), model.part().bodies.velocity, model.part().bodies.angular_velocity);
    evaluate();
  }

  void begin() {
    choose_step();
    motion_.stagger(state(), wrenches(), dt());
    model().part().ghosts.update(state().records, Spatial::record);
  }

  /// The forces at t_n are known: samples that are due see them, then bodies move to t_n+1.
  bool step(TS ts) {
    if (done() > 0) evaluate();
    if (!sample_if_due()) return false;
    if (!keep_step_stable(ts)) return false;
    const double speed2 = motion_.step(state(), wrenches(), dt());
    for (const auto& force : model().forces()) force->commit(state(), dt());
    release_broken();
    return moved(next_time(), speed2) && look_around();
  }

 private:
  /// Bodies whose beam broke in this step may touch from now on.
  void release_broken() {
    if (contact_ == nullptr || model().fracture() == nullptr) return;
    const auto pairs = model().fracture()->released();
    int any = pairs.empty() ? 0 : 1;
    MPI_Allreduce(MPI_IN_PLACE, &any, 1, MPI_INT, MPI_MAX, model().part().comm);
    if (any != 0) contact_->release(pairs);
  }
  StableStep find_stable_step() override {
    const StableStep stable = stable_step(model(), state());
    evaluate();  // forces keep by-products of their last evaluation: the power they take
    return stable;
  }
  /// Velocities lag half of the next step.
  void step_changed(TS, double before) override {
    motion_.stagger(state(), wrenches(), dt() - before);
  }
  Energies energies() const override {
    const auto [kinetic, boundary] = motion_.energies(state(), wrenches(), dt());
    return {kinetic, boundary};
  }
  void remember_own(Memory& memory) override {
    ExplicitRun::remember_own(memory);
    double work = motion_.boundary_work();
    memory.share("boundary_work", work);
    motion_.set_boundary_work(work);
  }

  Motion motion_;
  Contact* contact_ = nullptr;  ///< if the scene has it
};

RunResult run_leapfrog(Model<Spatial>& model, const ExplicitOptions& options,
                       const Observer<Spatial>& observer) {
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
  if (!run.restart()) run.begin();
  LeapfrogStep step = [&](double) { return run.guarded([&] { return run.step(ts); }); };
  set_leapfrog_step(ts, &step);
  return run.solve(ts);
}

}  // namespace

RunResult run_explicit(Model<Spatial>& model, const ExplicitOptions& options,
                       const Observer<Spatial>& observer) {
  return explicit_type() == TSRK ? run_rk(model, options, observer)
                                 : run_leapfrog(model, options, observer);
}

}  // namespace floe
