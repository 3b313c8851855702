/// \file
/// Newton's and Euler's equations of the bodies as one system y' = f(t, y) of first order, for time
/// integrators that work on vectors (model.md, "Explicit dynamics": Runge-Kutta).
///
/// On each rank y holds 13 numbers per owned body,
///   u' = v,  q' = (0, omega) q / 2,  v' = F/m,  L' = tau,   omega = R I^-1 R^T L,
/// (u displacement, q rotation from rest, L angular momentum in the world, R the principal axes),
/// followed by the integrals of this rank's powers: those of the forces (DoesWork::powers), and
/// that of the boundaries.
///
/// Prescribed components are not integrated: at every stage they have the boundary's value at the
/// stage's time. Where some components of the angular velocity are prescribed (h) and others free
/// (f), the reaction acts on L_h only; so L_f is integrated, J omega = L gives omega_f, then L_h.
///
/// Work of the boundaries: let h run over prescribed components. With m a_h = F_h + r_h and L_h' =
/// tau_h + r_h the reactions r do the work
///   sum m v_h^2/2 + omega_h L_h - integral (F_h v_h + tau_h omega_h + L_h omega_h') dt.
/// The first part follows from the state, also where v_h jumps; the integral is computed with y.
#pragma once

#include <span>
#include <vector>

#include "floe/base/rotation.h"
#include "model/model.h"

namespace floe {

/// The system of first order on this rank's owned bodies.
class FirstOrderSystem {
 public:
  static constexpr std::size_t width = 13;
  static constexpr std::size_t displacement = 0, rotation = 3, velocity = 7, momentum = 10;

  /// \param model  must outlive this object and already have its forces
  explicit FirstOrderSystem(const Model<Spatial>& model);

  /// Length of y on this rank, and the length of its part for bodies.
  std::size_t size() const { return bodies_size() + works(); }
  std::size_t bodies_size() const { return owned_ * width; }
  /// Number of integrals of power: those of the forces, in the order of WorkLedger::all(), and that
  /// of the boundaries.
  std::size_t works() const { return works_; }

  /// Sets the initial velocities and angular momenta of the bodies. Prescribed components get their
  /// prescribed velocities. Returns the boundaries' work for that, less work_of_state() [J].
  double begin(State<Spatial>& state);
  /// Stores, after a restart, the distance of prescribed components from their prescription, which
  /// later stages keep.
  void go_on(const State<Spatial>& state);

  /// Writes the records of owned bodies at a time from y: quaternions of unit length, prescribed
  /// components as prescribed, angular velocities from angular momenta.
  void to_records(std::span<const double> y, double time, State<Spatial>& state) const;
  /// Writes y from records, with zero integrals.
  void from_records(const State<Spatial>& state, std::span<double> y) const;
  /// Computes y' from a state and its wrenches.
  void rates(const State<Spatial>& state, const Wrenches<Spatial>& wrenches,
             std::span<double> rates) const;

  /// Returns this rank's kinetic energy [J].
  double kinetic(const State<Spatial>& state) const;
  /// Returns the part of the boundaries' work that follows from the state [J].
  double work_of_state(const State<Spatial>& state) const;
  /// Returns the square of the largest speed [m^2/s^2]; not finite if one of them is not.
  double largest_speed2(const State<Spatial>& state) const;

 private:
  struct Body {
    double mass;
    Vec3<double> inertia;
    Quat<double> axes;  // principal axes at rest
  };
  void prescribe(State<Spatial>& state) const;
  Vec3<double> spin(const Body& body, const Quat<double>& q, const Vec3<double>& l) const;
  void hold_spin(std::size_t body, const double* rate, double* record) const;
  bool fixed(std::size_t body, std::size_t k) const {
    return (model_.prescribed()[body] >> k & 1U) != 0;
  }

  const Model<Spatial>& model_;
  std::size_t owned_, works_ = 1;
  std::vector<Body> bodies_;
  std::vector<std::int32_t> held_;  ///< owned bodies with a prescribed component
  std::vector<double>
      offset_;  ///< per component of held bodies: displacement less prescription [m]
  mutable std::vector<double> place_, rate_, acceleration_;  ///< prescribed (work space)
};

}  // namespace floe
