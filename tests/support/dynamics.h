/// \file
/// A lattice in motion, stepped from outside: the step of run_explicit, without samples and limits.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <functional>
#include <memory>
#include <string>

#include "explicit/explicit.h"
#include "explicit/step.h"
#include "scene_model/scene_model.h"
#include "support/frames.h"

namespace floe::test {

/// Between steps the wrenches are those of the state: positions at t_n, velocities at t_n - dt/2.
template <class Space>
class DynamicsIn {
 public:
  /// \param more  adds further forces
  DynamicsIn(const Scene& scene, const Lattice& lattice, MPI_Comm comm = PETSC_COMM_SELF,
             const std::function<void(Model<Space>&)>& more = {})
      : model_(lattice, comm, scene.boundaries),
        state_(static_cast<std::size_t>(model_.part().local)),
        wrenches_(static_cast<std::size_t>(model_.part().local)),
        works_(with_forces(scene, lattice, model_, more)),
        step_(model_, state_, wrenches_, works_) {
    step_.start();
  }
  DynamicsIn(const DynamicsIn&) = delete;
  DynamicsIn& operator=(const DynamicsIn&) = delete;

  /// To be called once, before the first step.
  void set_step(double dt) {
    dt_ = dt;
    step_.stagger(dt_);
    evaluate();
  }
  /// The state is that of another run after set_step(dt).
  void go_on(double dt) { dt_ = dt; }
  /// Returns the square of the largest speed [m^2/s^2].
  double step() {
    const double largest = step_without_evaluation();
    evaluate();
    return largest;
  }
  /// As a checkpoint finds the forces: the next evaluation is yet to come.
  double step_without_evaluation() {
    const double largest = step_.advance(dt_);
    step_.commit(dt_);
    step_.release();
    return largest;
  }
  void steps(long count) {
    for (long n = 0; n < count; ++n) (void)step();
  }

  Model<Space>& model() { return model_; }
  State<Space>& state() { return state_; }
  const Wrenches<Space>& wrenches() const { return wrenches_; }
  void evaluate() { step_.evaluate(); }

  double boundary_work() const { return step_.boundary_work(); }
  double kinetic() const { return step_.energies(dt_).kinetic; }
  std::array<double, 6> momentum() const { return step_.momentum(dt_); }
  /// Works of the forces at the time of the state [J].
  std::vector<double> works() const { return step_.works(); }
  /// Saves or loads what a step needs beside the state and the histories of forces.
  void persist(Archive& archive) {
    works_.persist(archive);
    step_.persist(archive);
  }
  double reported(const std::string& name) const {
    for (const auto& [column, value] : model_.report(state_, step_.works())) {
      if (column == name) return value;
    }
    return 0;
  }

 private:
  /// Forces first: water that bodies take along adds to what LeapfrogStepper moves.
  static Model<Space>& with_forces(const Scene& scene, const Lattice& lattice, Model<Space>& model,
                                   const std::function<void(Model<Space>&)>& more) {
    add_forces(scene, place_loads(scene, lattice), model, &lattice);
    add_contact(scene, lattice, model);
    if (more) more(model);
    return model;
  }

  Model<Space> model_;
  State<Space> state_;
  Wrenches<Space> wrenches_;
  WorkLedger works_;
  ExplicitStep<Space> step_;
  double dt_ = 0;
};
using Dynamics = DynamicsIn<Spatial>;

/// Expects this rank's bodies to be those of a run on one process, to the last bit. Returns the
/// largest displacement among them [m].
template <class Space>
double expect_same_bits(DynamicsIn<Space>& together, DynamicsIn<Space>& alone) {
  const Part &part = together.model().part(), &whole = alone.model().part();
  double moved = 0;
  for (std::int32_t b = 0; b < part.owned; ++b) {
    const std::int32_t global = part.global[static_cast<std::size_t>(b)];
    const double* here = together.state().record(static_cast<std::size_t>(b));
    const double* there = alone.state().record(static_cast<std::size_t>(whole.local_index(global)));
    EXPECT_EQ(std::memcmp(here, there, Space::record * sizeof(double)), 0) << "body " << global;
    for (int k = 0; k < Space::translations; ++k) moved = std::max(moved, std::abs(here[k]));
  }
  return moved;
}

/// Gives a frame of equal beams the masses of its material: half beams to either end, rotary
/// inertias of its section (about axis 1 the polar one). Beams lie along x, axis 2 along y.
inline void give_mass(Lattice& frame, const FrameSection& section, double density) {
  Bodies& bodies = frame.bodies;
  std::vector<double> tributary(bodies.position.size(), 0);
  for (std::size_t m = 0; m < frame.beams.bodies.size(); ++m) {
    for (const std::int32_t b : frame.beams.bodies[m])
      tributary[static_cast<std::size_t>(b)] += 0.5 * frame.beams.length[m];
  }
  for (std::size_t b = 0; b < tributary.size(); ++b) {
    const double line = density * tributary[b];
    bodies.mass[b] = line * section.area;
    bodies.inertia[b] = {line * (section.inertia_y + section.inertia_z), line * section.inertia_y,
                         line * section.inertia_z};
  }
}

/// A scene of beams and nothing else.
inline Scene beams_only(Shear shear, double damping = 0, DampingModes modes = DampingModes::all) {
  Scene scene;
  scene.forces.beam = true;
  scene.beam.shear = shear;
  scene.beam.damping_ratio = damping;
  scene.beam.damping_modes = modes;
  return scene;
}

}  // namespace floe::test
