#include "explicit/explicit.h"

#include <algorithm>
#include <memory>

#include "explicit/device_run.h"
#include "explicit/explicit_run.h"
#include "explicit/explicit_ts_options.h"
#include "explicit/leapfrog.h"
#include "explicit/step.h"
#include "stability/stable_step.h"

namespace floe {
namespace {

/// A run by leapfrog, whose velocities lag half a step behind positions.
template <class Space>
class LeapfrogRun final : public ExplicitRun<Space> {
  using Base = ExplicitRun<Space>;

 public:
  LeapfrogRun(Model<Space>& model, const ExplicitOptions& options, Observer<Space> observer)
      : Base(ts_leapfrog, model, options, std::move(observer)) {
    this->result().stepper = ts_leapfrog;
    register_leapfrog();
    check(TSCreate(model.part().comm, this->ts_.put()));
    check(TSSetType(this->ts_, ts_leapfrog));
    follow_model();
    step_->start();
    this->read_options();
  }

  bool prepare() override {
    if (!this->restart()) begin();
    set_leapfrog_step(this->ts_, &make_step_);
    return this->announce();
  }

 private:
  void begin() {
    this->choose_step();
    stagger();
  }
  void stagger() {
    step_->stagger(this->dt());
    this->model().part().ghosts.update(this->state().records, Space::record);
  }
  bool can_go_back() const override { return true; }
  void begin_again() override {
    State<Space>& state = this->state();
    std::fill(state.records.begin(), state.records.end(), 0.0);
    for (std::size_t b = 0; b < static_cast<std::size_t>(this->model().part().local); ++b)
      Space::at_rest(state.record(b));
    state.set_time(0);
    step_->start();
    stagger();
  }

  /// Makes a step. The forces at t_n are known; a sample that is due gets them before the bodies
  /// move to t_n+1.
  bool step() {
    if (this->done() > 0) step_->evaluate();
    if (!this->sample_if_due()) return false;
    if (!this->keep_step_stable()) return false;
    const double speed2 = step_->advance(this->dt());
    step_->commit(this->dt());
    step_->release();
    return this->moved(this->next_time(), speed2) && this->look_around();
  }

  StableStep find_stable_step() override {
    StableStep stable = stable_step(this->model(), this->state());
    // Forces keep by-products of their last evaluation (their power), which the search has changed.
    evaluate();
    return stable;
  }
  void evaluate() override { step_->evaluate(); }
  std::vector<double> works() const override { return step_->works(); }
  void follow_model() override {
    Model<Space>& model = this->model();
    const Part& part = model.part();
    step_ = std::make_unique<ExplicitStep<Space>>(model, this->state(), this->wrenches(),
                                                  this->work_ledger());
    check(VecCreateMPIWithArray(part.comm, Space::record, part.owned * Space::record,
                                PETSC_DETERMINE, this->state().records.data(), solution_.put()));
    check(TSSetSolution(this->ts_, solution_));
  }
  /// Keeps velocities half of the next step behind.
  void step_changed(double before) override { step_->stagger(this->dt() - before); }
  typename Base::Energies energies() const override {
    const auto [kinetic, boundary] = step_->energies(this->dt());
    return {kinetic, boundary};
  }
  void persist_own(Archive& archive) override {
    Base::persist_own(archive);
    step_->persist(archive);
  }

  std::unique_ptr<ExplicitStep<Space>> step_;
  Handle<Vec> solution_;
  LeapfrogStep make_step_ = [this](double) { return this->guarded([this] { return step(); }); };
};

}  // namespace

std::string explicit_needs_space(Backend backend) {
  if (explicit_type() == TSRK) return "-ts_type rk steps bodies in space";
  if (backend != Backend::cpu)
    return "backend: " + std::string(name_of(backend)) + " steps bodies in space";
  return "";
}

template <class Space>
std::unique_ptr<Run> make_explicit_run(Model<Space>& model, const ExplicitOptions& options,
                                       ObserverOf<Space> observer) {
  if constexpr (std::is_same_v<Space, Spatial>) {
    if (options.backend != Backend::cpu && options.supply)
      throw InputError("supply: backend: " + std::string(name_of(options.backend)) +
                       " steps a lattice that stays as it is; backend: cpu lets ice join");
    if (options.backend != Backend::cpu)
      return make_device_run(model, options, std::move(observer));
  }
  if (explicit_type() != TSRK)
    return std::make_unique<LeapfrogRun<Space>>(model, options, std::move(observer));
  if (options.supply) throw InputError("supply: -ts_type rk steps a lattice that stays as it is");
  if constexpr (std::is_same_v<Space, Spatial>) {
    return make_rk_run(model, options, std::move(observer));
  } else {
    throw InputError("model: planar: " + explicit_needs_space(options.backend));
  }
}

template std::unique_ptr<Run> make_explicit_run(Model<Spatial>&, const ExplicitOptions&,
                                                Observer<Spatial>);
template std::unique_ptr<Run> make_explicit_run(Model<Planar>&, const ExplicitOptions&,
                                                Observer<Planar>);

}  // namespace floe
