/// \file
/// The explicit update of the motion of all bodies of a rank.
#pragma once

#include <array>
#include <span>
#include <utility>
#include <vector>

#include "base/simd.h"
#include "leapfrog/rigid_body_step_lanes.h"
#include "model/model.h"

namespace floe {

/// Leapfrog of a rank's owned bodies (model.md, "Explicit dynamics"). Positions are at t_n,
/// velocities and momenta at t_n - dt/2.
class LeapfrogStepper {
 public:
  explicit LeapfrogStepper(const Model<Spatial>& model);

  /// Sets velocities and angular momenta of the state from initial velocities [m/s] and angular
  /// velocities [rad/s] in the world; all are at t_0.
  void start(State<Spatial>& state, const std::vector<Point3>& velocity,
             const std::vector<Point3>& spin) const;
  /// Moves velocities back from t_0 to t_0 - dt/2.
  void stagger(State<Spatial>& state, const Wrenches<Spatial>& wrenches, double dt) const;

  /// Steps from t_n to t_n + dt with the wrenches at t_n. Returns the square of the largest speed
  /// of a body [m^2/s^2], which is not finite if a body's speed is not. Stores that speed and the
  /// largest angular velocity in the state.
  double step(State<Spatial>& state, const Wrenches<Spatial>& wrenches, double dt);

  /// Exchanges the velocities after a step with those after its kick, with which forces do their
  /// work. They differ only for bodies with added mass by direction, whose axes turn in the drift.
  void swap_kicked(State<Spatial>& state);

  /// Kinetic energy of this rank's bodies, and the boundaries' work on them since the start, at t_n
  /// [J].
  struct Energies {
    double kinetic, boundary;
  };
  /// Returns the energies in leapfrog's own form: kinetic energy 1/2 v_(n-1/2).M v_(n+1/2), and
  /// work by the mean of the forces at a step's two ends. With the potential energy at t_n their
  /// balance is exact for a linear system at any stable step, where 1/2 v_n.M v_n swings by up to
  /// (omega dt)^2/4.
  Energies energies(const State<Spatial>& state, const Wrenches<Spatial>& wrenches,
                    double dt) const;
  /// Returns the linear momentum [kg m/s] and the angular momentum about the origin [kg m^2/s] of
  /// this rank's bodies at t_n.
  std::array<double, 6> momentum(const State<Spatial>& state, const Wrenches<Spatial>& wrenches,
                                 double dt) const;
  /// Work that boundaries have done on this rank's bodies since the start [J].
  double boundary_work() const { return boundary_work_; }
  void set_boundary_work(double work) { boundary_work_ = work; }

 private:
  std::pair<Vec3<double>, Vec3<double>> half_step_on(std::int32_t body, const State<Spatial>& state,
                                                     const Wrenches<Spatial>& wrenches,
                                                     double dt) const;
  struct alignas(64) Block {
    std::array<std::array<double, lanes>, 8> values;  ///< 1/m, 1/I, axes
    BodyConstants<Lanes> get() const;
  };
  struct Extremes {
    Lanes speed2{0.0}, spin2{0.0}, sum{0.0};  ///< largest squares; sum of those of speeds
  };
  /// Masses along the principal axes, of bodies with added inertia.
  struct alignas(64) MassBlock {
    std::array<std::array<double, lanes>, 3> values;
    Vec3<Lanes> get() const;
  };
  template <bool added>
  static Extremes step_blocks(std::span<const Block> blocks, const MassBlock* masses,
                              const double* free, double* records, const double* wrenches,
                              double* kicked, double dt);
  std::array<double, 2> step_all(State<Spatial>& state, const Wrenches<Spatial>& wrenches,
                                 double dt);
  void step_held(std::int32_t body, const double* before, State<Spatial>& state,
                 const Wrenches<Spatial>& wrenches, std::span<const double> now,
                 std::span<const double> next, double dt);
  BodyConstants<double> constants(std::int32_t body) const;
  Vec3<double> masses(std::int32_t body) const;
  Vec3<double> momentum_of(std::int32_t body, const Triad<double>& axes,
                           const Vec3<double>& velocity) const;
  Vec3<double> velocity_of(std::int32_t body, const Triad<double>& axes,
                           const Vec3<double>& momentum) const;

  const Model<Spatial>& model_;
  const Part& part_;
  std::vector<Block> blocks_;
  std::vector<MassBlock> masses_;  ///< empty: masses are alike in all directions
  /// Velocities after the last kick, of bodies with added inertia [m/s].
  std::vector<double> kicked_;
  std::vector<std::int32_t> held_;          ///< owned bodies with a prescribed unknown
  std::vector<std::int32_t> rows_;          ///< per local body: its index in held_, or -1
  std::vector<double> free_;                ///< per body: 1, or 0 if it is held; empty: none is
  std::vector<double> saved_;               ///< records of held_ before a step
  mutable std::vector<double> now_, next_;  ///< prescribed values of held_ (work space)
  double boundary_work_ = 0;
};

}  // namespace floe
