#include "explicit/explicit.h"

#include "explicit/explicit_run.h"
#include "explicit/explicit_ts_options.h"
#include "explicit/leapfrog.h"
#include "explicit/stable_step.h"
#include "explicit/step.h"

namespace floe {
namespace {

/// A run by leapfrog, whose velocities lag half a step behind positions.
template <class Space>
class LeapfrogRun final : public ExplicitRun<Space> {
  using Base = ExplicitRun<Space>;

 public:
  LeapfrogRun(Model<Space>& model, const ExplicitOptions& options, const Observer<Space>& observer)
      : Base(ts_leapfrog, model, options, observer), step_(model, this->state(), this->wrenches()) {
    this->result().stepper = ts_leapfrog;
    step_.start();
  }

  void begin() {
    this->choose_step();
    step_.stagger(this->dt());
    this->model().part().ghosts.update(this->state().records, Space::record);
  }

  /// Makes a step. The forces at t_n are known; a sample that is due gets them before the bodies
  /// move to t_n+1.
  bool step(TS ts) {
    if (this->done() > 0) step_.evaluate();
    if (!this->sample_if_due()) return false;
    if (!this->keep_step_stable(ts)) return false;
    const double speed2 = step_.advance(this->dt());
    step_.commit(this->dt());
    step_.release();
    return this->moved(this->next_time(), speed2) && this->look_around();
  }

 private:
  StableStep find_stable_step() override {
    StableStep stable = stable_step(this->model(), this->state());
    // Forces keep by-products of their last evaluation (their power), which the search has changed.
    this->evaluate();
    return stable;
  }
  /// Keeps velocities half of the next step behind.
  void step_changed(TS, double before) override { step_.stagger(this->dt() - before); }
  typename Base::Energies energies() const override {
    const auto [kinetic, boundary] = step_.energies(this->dt());
    return {kinetic, boundary};
  }
  void persist_own(Archive& archive) override {
    Base::persist_own(archive);
    double work = step_.boundary_work();
    archive.share("boundary_work", work);
    step_.set_boundary_work(work);
  }

  ExplicitStep<Space> step_;
};

template <class Space>
RunResult run_leapfrog(Model<Space>& model, const ExplicitOptions& options,
                       const Observer<Space>& observer) {
  register_leapfrog();
  LeapfrogRun<Space> run(model, options, observer);
  const Part& part = model.part();
  Handle<Vec> solution;
  check(VecCreateMPIWithArray(part.comm, Space::record, part.owned * Space::record, PETSC_DETERMINE,
                              run.state().records.data(), solution.put()));
  Handle<TS> ts;
  check(TSCreate(part.comm, ts.put()));
  check(TSSetType(ts, ts_leapfrog));
  check(TSSetSolution(ts, solution));
  run.read_options(ts);
  if (!run.restart()) run.begin();
  if (!run.announce()) return {};
  LeapfrogStep step = [&](double) { return run.guarded([&] { return run.step(ts); }); };
  set_leapfrog_step(ts, &step);
  return run.solve(ts);
}

}  // namespace

std::string explicit_needs_space() {
  return explicit_type() == TSRK ? "-ts_type rk steps bodies in space" : "";
}

template <class Space>
RunResult run_explicit(Model<Space>& model, const ExplicitOptions& options,
                       const ObserverOf<Space>& observer) {
  if (explicit_type() != TSRK) return run_leapfrog(model, options, observer);
  if constexpr (std::is_same_v<Space, Spatial>) {
    return run_rk(model, options, observer);
  } else {
    throw InputError("model: planar: " + explicit_needs_space());
  }
}

template RunResult run_explicit(Model<Spatial>&, const ExplicitOptions&, const Observer<Spatial>&);
template RunResult run_explicit(Model<Planar>&, const ExplicitOptions&, const Observer<Planar>&);

}  // namespace floe
