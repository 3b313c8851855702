#include "explicit/device_run.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <vector>

#include "device/batch.h"
#include "device/device_stepper.h"
#include "device/make_engine.h"
#include "explicit/explicit_run.h"
#include "explicit/leapfrog.h"
#include "explicit/step.h"
#include "files/hdf5.h"
#include "stability/stable_step.h"

namespace floe {
namespace {

/// Steps are queued; nobody looks at them before so many are made, which divides those between two
/// checks of the velocity limit.
constexpr std::int64_t most_queued = 50;
/// Steps between looks at the stable step where no sample is due: each brings the state back.
constexpr std::int64_t look_every = 1000;

/// The engine of this run alone, or of the batch that the process belongs to.
std::unique_ptr<device::Engine> make_engine(Backend backend, const device::Lattice& lattice) {
  try {
    if (const auto batch = device::connection_to_batch())
      return device::join_batch(*batch, lattice);
    return device::make_engine(name_of(backend), {lattice});
  } catch (const device::Failed& error) {
    throw RunFailed(error.what());
  }
}

/// A run by leapfrog whose state an engine keeps.
class DeviceRun final : public ExplicitRun<Spatial> {
 public:
  DeviceRun(Model<Spatial>& model, const ExplicitOptions& options, Observer<Spatial> observer)
      : ExplicitRun(ts_leapfrog, model, options, std::move(observer)) {
    result().stepper = ts_leapfrog;
    register_leapfrog();
    check(TSCreate(model.part().comm, ts_.put()));
    check(TSSetType(ts_, ts_leapfrog));
    device::DescribedModel described = device::describe(model, name_of(options.backend));
    auto engine = make_engine(options.backend, described.lattice);
    stepper_ =
        std::make_unique<device::DeviceStepper>(model, std::move(described), std::move(engine));
    step_ = std::make_unique<ExplicitStep<Spatial>>(model, state(), wrenches(), work_ledger());
    const Part& part = model.part();
    check(VecCreateMPIWithArray(part.comm, Spatial::record, part.owned * Spatial::record,
                                PETSC_DETERMINE, state().records.data(), solution_.put()));
    check(TSSetSolution(ts_, solution_));
    step_->start();
    read_options();
  }

  bool prepare() override {
    if (!restart()) {
      choose_step();
      stagger(dt());
    }
    set_leapfrog_step(ts_, &make_step_);
    return announce();
  }

 private:
  void stagger(double by) {
    step_->stagger(by);
    forces_are_of_other_velocities_ = true;
  }
  bool step() {
    // While bodies may be about to touch for the first time, on which the step depends.
    const bool watches = is_on_engine_ && stepper_->watches(),
               were_possible = contacts_are_possible_;
    contacts_are_possible_ = stepper_->contacts_are_possible();
    const bool looks =
        due() || watches || contacts_are_possible_ != were_possible || done() % look_every == 0;
    if (looks && done() > 0) evaluate();
    if (!sample_if_due()) return false;
    if (looks && !keep_step_stable()) return false;
    const double speed2 = forces_are_of_other_velocities_ ? step_here() : queue_step();
    last_dt_ = dt();
    return moved(next_time(), speed2) && look_around();
  }
  /// The step after velocities have been staggered, which begins with the forces before that.
  double step_here() {
    const double speed2 = step_->advance(dt());
    step_->commit(dt());
    step_->release();
    forces_are_of_other_velocities_ = is_on_engine_ = false;
    restored_.reset();
    return speed2;
  }
  /// Returns the square of the largest speed in the steps that were made; perhaps none [m^2/s^2].
  double queue_step() {
    if (!is_on_engine_) {
      if (restored_) check_parts();
      const auto works = work_ledger().all();
      stepper_->put(state(), restored_
                                 ? *restored_
                                 : device::DeviceStepper::WorkParts{
                                       {works.begin(), works.end()}, step_->boundary_work(), {}});
      restored_.reset();
    }
    is_on_engine_ = true;
    stepper_->queue(state().time, dt(), last_dt_);
    is_here_ = false;
    const bool is_full = (done() + 1) % most_queued == 0 || !contacts_are_possible_;
    return is_full ? stepper_->flush() : 0.0;
  }

  /// Makes the queued steps, so that their speeds are known.
  void finish_steps() override { note_speed2(stepper_->flush()); }
  /// Brings back the state and what forces and boundaries have worked.
  void bring_state() override {
    if (is_here_) return;
    finish_steps();
    stepper_->get(state());
    step_->take_over(stepper_->take_works(work_ledger().all()), last_dt_);
    state().velocity_time = state().time - 0.5 * last_dt_;
    is_here_ = true;
  }
  void evaluate() override {
    bring_state();
    step_->evaluate();
  }
  StableStep find_stable_step() override {
    bring_state();
    StableStep stable = stable_step(model(), state());
    evaluate();
    return stable;
  }
  std::vector<double> works() const override { return step_->works(); }
  void step_changed(double before) override { stagger(dt() - before); }
  Energies energies() const override {
    const auto [kinetic, boundary] = step_->energies(dt());
    return {kinetic, boundary};
  }
  /// How long a step takes is not known: looks are the processor's.
  void add_to(RunPlan& plan) const override {
    ExplicitRun::add_to(plan);
    plan.seconds_a_step = 0;
    plan.measured.clear();
  }
  void persist_own(Archive& archive) override {
    ExplicitRun::persist_own(archive);
    step_->persist(archive);
    last_dt_ = step_->last_dt();
    if (archive.loading()) {
      is_on_engine_ = false;
      restored_.reset();
      // Not in checkpoints of the processor
      if (Hdf5File::open(options().checkpoint.restart, "checkpoint: restart")
              .has("run/parts_until"))
        persist_parts(archive, restored_.emplace());
    } else if (is_on_engine_) {
      device::DeviceStepper::WorkParts parts = stepper_->work_parts();
      persist_parts(archive, parts);
    }
  }
  static void persist_parts(Archive& archive, device::DeviceStepper::WorkParts& parts) {
    archive.common("parts_until", parts.until);
    archive.common("parts_boundaries", parts.boundaries);
    archive.common("parts_beams", parts.since.beams);
    archive.common("parts_held", parts.since.held);
    archive.common("parts_loaded", parts.since.loaded);
    archive.common("parts_drag", parts.since.drag);
    archive.common("parts_buoyancy", parts.since.buoyancy);
    archive.common("parts_supports", parts.since.supports);
    archive.common("parts_contacts", parts.since.contacts);
    archive.common("parts_obstacles", parts.since.obstacles);
  }
  /// Drops parts of works that are not those of the sums: those of a run with other loads.
  void check_parts() {
    std::vector<double> works(work_ledger().all().size());
    const auto boundaries = stepper_->sum(*restored_, works);
    if (boundaries != step_->boundary_work() ||
        !std::equal(works.begin(), works.end(), work_ledger().all().begin()))
      restored_.reset();
  }

  std::unique_ptr<device::DeviceStepper> stepper_;
  std::optional<device::DeviceStepper::WorkParts> restored_;  ///< of a checkpoint
  std::unique_ptr<ExplicitStep<Spatial>> step_;               ///< for looks at the state
  Handle<Vec> solution_;
  /// The engine has the state at the last step; the object `state()` has it.
  bool is_on_engine_ = false, is_here_ = true;
  bool forces_are_of_other_velocities_ = false;
  bool contacts_are_possible_ = true;  ///< at the last step
  double last_dt_ = 0;                 ///< length of the last step, also if it is queued [s]
  LeapfrogStep make_step_ = [this](double) { return guarded([this] { return step(); }); };
};

}  // namespace

std::unique_ptr<Run> make_device_run(Model<Spatial>& model, const ExplicitOptions& options,
                                     Observer<Spatial> observer) {
  return std::make_unique<DeviceRun>(model, options, std::move(observer));
}

}  // namespace floe
