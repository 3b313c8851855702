/// \file
/// The explicit update of the motion of planar bodies, which turn about z only; the counterpart of
/// leapfrog_stepper.h.
#pragma once

#include <array>
#include <type_traits>
#include <vector>

#include "leapfrog/leapfrog_stepper.h"
#include "model/model.h"

namespace floe {

/// Leapfrog of a rank's owned bodies. Positions and angles are at t_n, their rates at t_n - dt/2.
/// Each of a body's three unknowns moves independently, with the mass or the moment of inertia
/// about z.
class PlanarLeapfrogStepper {
 public:
  explicit PlanarLeapfrogStepper(const Model<Planar>& model);

  /// Sets velocities of the state from initial velocities [m/s] and angular velocities [rad/s] in
  /// the world; all are at t_0.
  void start(State<Planar>& state, const std::vector<Point3>& velocity,
             const std::vector<Point3>& spin) const;
  /// Moves velocities back from t_0 to t_0 - dt/2.
  void stagger(State<Planar>& state, const Wrenches<Planar>& wrenches, double dt) const;

  /// Steps from t_n to t_n + dt with the wrenches at t_n. Returns the square of the largest speed
  /// of a body [m^2/s^2], which is not finite if a body's speed is not.
  double step(State<Planar>& state, const Wrenches<Planar>& wrenches, double dt);

  /// These functions correspond to those of LeapfrogStepper.
  using Energies = LeapfrogStepper::Energies;
  Energies energies(const State<Planar>& state, const Wrenches<Planar>& wrenches, double dt) const;
  std::array<double, 6> momentum(const State<Planar>& state, const Wrenches<Planar>& wrenches,
                                 double dt) const;
  double boundary_work() const { return boundary_work_; }
  void set_boundary_work(double work) { boundary_work_ = work; }

 private:
  static constexpr std::size_t n = Planar::unknowns;
  struct alignas(32) Inverse {
    std::array<double, 4> values;  ///< 1/m, 1/m, 1/I, 0
  };
  double step_free(State<Planar>& state, const Wrenches<Planar>& wrenches, double dt) const;
  void step_held(std::int32_t body, const double* before, double* record, double dt);
  bool fixed(std::size_t body, std::size_t k) const {
    return (model_.prescribed()[body] >> k & 1U) != 0;
  }
  bool is_held(std::size_t body) const { return model_.prescribed()[body] != 0; }
  void prescribe(double time, double dt) const;
  double given(std::size_t body, std::size_t k, double dt) const {
    return (next_[body * n + k] - now_[body * n + k]) / dt;
  }

  const Model<Planar>& model_;
  const Part& part_;
  std::vector<Inverse> inverse_;
  std::vector<std::int32_t> held_;          ///< owned bodies with a prescribed unknown
  std::vector<double> saved_;               ///< records of held_ before a step
  mutable std::vector<double> now_, next_;  ///< prescribed values (work space)
  double boundary_work_ = 0;
};

/// The stepper of the bodies of a space.
template <class Space>
using LeapfrogStepperOf =
    std::conditional_t<std::is_same_v<Space, Planar>, PlanarLeapfrogStepper, LeapfrogStepper>;

}  // namespace floe
