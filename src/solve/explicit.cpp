#include "floe/forces/contact.h"
#include "floe/forces/fracture.h"
#include "solve/explicit_run.h"
#include "solve/leapfrog.h"
#include "solve/planar_motion.h"
#include "solve/stable_step.h"
#include "solve/ts_options.h"

namespace floe {
namespace {

/// Leapfrog's run: velocities half a step behind positions.
template <class Space>
class LeapfrogRun final : public ExplicitRun<Space> {
  using Base = ExplicitRun<Space>;

 public:
  LeapfrogRun(Model<Space>& model, const ExplicitOptions& options, const Observer<Space>& observer)
      : Base(ts_leapfrog, model, options, observer), motion_(model) {
    this->result().stepper = ts_leapfrog;
    for (const auto& force : model.forces()) {
      if (auto* contact = dynamic_cast<Contact*>(force.get())) contact_ = contact;
    }
    motion_.start(this->state(), model.part().bodies.velocity,
                  model.part().bodies.angular_velocity);
    this->evaluate();
  }

  void begin() {
    this->choose_step();
    motion_.stagger(this->state(), this->wrenches(), this->dt());
    this->model().part().ghosts.update(this->state().records, Space::record);
  }

  /// The forces at t_n are known: samples that are due see them, then bodies move to t_n+1.
  bool step(TS ts) {
    if (this->done() > 0) this->evaluate();
    if (!this->sample_if_due()) return false;
    if (!this->keep_step_stable(ts)) return false;
    const double speed2 = motion_.step(this->state(), this->wrenches(), this->dt());
    for (const auto& force : this->model().forces()) force->commit(this->state(), this->dt());
    release_broken();
    return this->moved(this->next_time(), speed2) && this->look_around();
  }

 private:
  /// Bodies whose beam broke in this step may touch from now on.
  void release_broken() {
    if (contact_ == nullptr || this->model().fracture() == nullptr) return;
    const auto pairs = this->model().fracture()->released();
    int any = pairs.empty() ? 0 : 1;
    MPI_Allreduce(MPI_IN_PLACE, &any, 1, MPI_INT, MPI_MAX, this->model().part().comm);
    if (any != 0) contact_->release(pairs);
  }
  StableStep find_stable_step() override {
    StableStep stable = stable_step(this->model(), this->state());
    this->evaluate();  // forces keep by-products of their last evaluation: the power they take
    return stable;
  }
  /// Velocities lag half of the next step.
  void step_changed(TS, double before) override {
    motion_.stagger(this->state(), this->wrenches(), this->dt() - before);
  }
  typename Base::Energies energies() const override {
    const auto [kinetic, boundary] = motion_.energies(this->state(), this->wrenches(), this->dt());
    return {kinetic, boundary};
  }
  void remember_own(Memory& memory) override {
    Base::remember_own(memory);
    double work = motion_.boundary_work();
    memory.share("boundary_work", work);
    motion_.set_boundary_work(work);
  }

  MotionOf<Space> motion_;
  Contact* contact_ = nullptr;  ///< if the scene has it
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
