/// \file
/// One step of explicit dynamics: evaluate, advance, commit, release. The integrator of a run
/// (explicit.cpp), tests, and any other back end of the step use these functions.
#pragma once

#include <vector>

#include "base/collectives.h"
#include "leapfrog/leapfrog_work.h"
#include "leapfrog/planar_leapfrog_stepper.h"
#include "model/model.h"
#include "run/work_ledger.h"

namespace floe {

/// Leapfrog with positions at t_n, velocities at t_n - dt/2, the wrenches of the last evaluation,
/// and the works of the forces.
template <class Space>
class ExplicitStep {
 public:
  using Energies = LeapfrogStepper::Energies;

  /// All must outlive this object.
  /// \param model  with all of its forces
  /// \param works  of the model's forces; commit() adds to them
  ExplicitStep(Model<Space>& model, State<Space>& state, Wrenches<Space>& wrenches,
               WorkLedger& works)
      : model_(model),
        state_(state),
        wrenches_(wrenches),
        stepper_(model),
        work_(model.forces(), works.all()) {
    for (const auto& force : model.forces())
      if (auto* role = force->roles().prepares) preparing_.push_back(role);
  }

  /// Sets the bodies' initial velocities, at t_0, and evaluates the forces. Collective.
  void start() {
    const Bodies& bodies = model_.part().bodies;
    stepper_.start(state_, bodies.velocity, bodies.angular_velocity);
    evaluate();
  }
  /// Moves velocities back by half of dt [s], with the wrenches of the last evaluation.
  void stagger(double dt) {
    stepper_.stagger(state_, wrenches_, dt);
    state_.velocity_time -= 0.5 * dt;
  }

  /// Evaluates all forces at t_n, with the velocities half of the last step before. Collective.
  void evaluate() {
    state_.velocity_time = state_.time - 0.5 * work_.last_dt();
    model_.part().ghosts.update(state_.records, Space::record);
    for (auto* force : preparing_) force->before_evaluation(state_);
    model_.evaluate(state_, wrenches_);
    for (auto* force : preparing_) force->after_evaluation();
  }
  /// Kick and drift of the owned bodies, from t_n to t_n + dt. Returns the square of the largest
  /// speed [m^2/s^2], which is not finite if a body's speed is not.
  double advance(double dt) {
    const double middle = state_.time + 0.5 * dt;
    const double speed2 = stepper_.step(state_, wrenches_, dt);
    state_.velocity_time = middle;
    return speed2;
  }
  /// Lets forces take over the history of the step (damage, slip), and adds the step to their
  /// works. Collective.
  void commit(double dt) {
    work_.take_powers();
    for (const auto& force : model_.forces()) {
      if (auto* role = force->roles().commits) role->commit(state_, dt);
    }
    if constexpr (std::is_same_v<Space, Spatial>) {
      stepper_.swap_kicked(state_);
      work_.take_step(state_, dt);
      stepper_.swap_kicked(state_);
    } else {
      work_.take_step(state_, dt);
    }
  }
  /// Makes pairs whose beam broke in this step eligible for contact from the next evaluation on.
  /// Collective.
  void release() {
    if (model_.fracture() == nullptr) return;
    const auto pairs = model_.fracture()->released();
    for (const auto& force : model_.forces()) {
      auto* role = force->roles().broken_pairs;
      if (role != nullptr && on_any_rank(!pairs.empty(), model_.part().comm)) role->release(pairs);
    }
  }

  /// Kinetic energy of this rank's bodies, and the boundaries' work on them since the start, at t_n
  /// [J].
  Energies energies(double dt) const { return stepper_.energies(state_, wrenches_, dt); }
  /// Linear momentum [kg m/s] and angular momentum about the origin [kg m^2/s] of this rank's
  /// bodies at t_n.
  std::array<double, 6> momentum(double dt) const {
    return stepper_.momentum(state_, wrenches_, dt);
  }
  /// Works of the forces at t_n, of which evaluate() has found the forces [J].
  std::vector<double> works() const { return work_.works(); }
  double boundary_work() const { return stepper_.boundary_work(); }
  double last_dt() const { return work_.last_dt(); }
  /// Takes note of steps that were made elsewhere, whose works are in the ledger.
  /// \param work  by boundaries since the start [J] \param dt  length of the last step [s]
  void take_over(double work, double dt) {
    stepper_.set_boundary_work(work);
    work_.set_last_dt(dt);
  }
  /// Saves or loads what the next step needs beside the state and the works. Collective.
  void persist(Archive& archive) {
    double work = stepper_.boundary_work();
    archive.share("boundary_work", work);
    stepper_.set_boundary_work(work);
    work_.persist(archive);
  }

 private:
  Model<Space>& model_;
  State<Space>& state_;
  Wrenches<Space>& wrenches_;
  LeapfrogStepperOf<Space> stepper_;
  LeapfrogWork<Space> work_;
  std::vector<PreparesSteps<Space>*> preparing_;
};

}  // namespace floe
