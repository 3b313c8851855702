/// \file
/// Rotations of bodies as unknowns of implicit dynamics (model.md, "Implicit dynamics").
///
/// A body's unknown U is the running sum of rotation increments in one of three frames E:
///
///     body    q = q_ref exp(U - U_ref), E = R(q): V is the angular velocity in the body, where the
///             tensor of inertia is constant; order and energy of a free top are best in this frame
///     world   q = exp(U - U_ref) q_ref, E = 1: where a component of the rotation is prescribed, as
///             prescriptions are in world axes
///     small   q = (1, U/2), E = 1: linear kinematics, without gyroscopic moments
///
/// In each frame the angular velocity is omega = E V and the balance of moments is
///
///     J A + V x J V = E^T m,   J = E^T (R J_0 R^T) E,   J_0 the tensor of inertia at rest.
///
/// A change of U turns a body by the spin E T, T = T(-theta) in the body and T(theta) in the world,
/// theta = U - U_ref, T(theta) = 1 + (1 - cos)/theta^2 [theta] + (theta - sin)/theta^3 [theta]^2.
#pragma once

#include <Eigen/Core>

#include <cstdint>
#include <span>
#include <vector>

#include "model/model.h"

namespace floe {

/// Rotations of a rank's bodies. Bodies are local indices; only owned bodies have an inertia.
template <class Space>
class ImplicitRotations;

template <>
class ImplicitRotations<Spatial> {
 public:
  static constexpr std::size_t size = 3;
  using Vector = Eigen::Vector3d;
  using Matrix = Eigen::Matrix3d;

  /// \param model  must outlive this object
  explicit ImplicitRotations(const Model<Spatial>& model);

  /// Sets rotation, angular velocity and angular momentum of a record from U [rad] and V [rad/s].
  void take(std::size_t body, const Vector& u, const Vector& v, double* record) const;
  /// Moves the reference to U and to the record's rotation, which must be that of U.
  void rebase(std::size_t body, const Vector& u, const double* record);
  /// References of all owned bodies, 7 numbers each (q, U), and their restoration.
  std::vector<double> references() const;
  void set_references(std::span<const double> values);
  static constexpr std::size_t reference_size = 7;
  /// U - U_ref [rad].
  Vector increment(std::size_t body, const Vector& u) const { return u - reference_[body].u; }

  /// Transforms a vector from the world to the frame, and back.
  Vector to_frame(std::size_t body, const double* record, const Vector& world) const;
  Vector to_world(std::size_t body, const double* record, const Vector& frame) const;
  /// Returns J A + V x J V [N m].
  Vector inertia_moment(std::size_t body, const double* record, const Vector& v,
                        const Vector& a) const;
  /// Solves the balance with a moment in the frame for A; prescribed components of A keep their
  /// values.
  Vector acceleration(std::size_t body, const double* record, const Vector& v, const Vector& moment,
                      Vector a) const;
  /// Kinetic energy of the rotation [J].
  double kinetic(std::size_t body, const double* record, const Vector& v) const;

  /// Maps from changes of U to the spin of a body and its moment: exact, or those that keep a
  /// symmetric matrix symmetric. velocity_frame() is for derivatives to velocities: V changes with
  /// U by the factor by_velocity, which the matrix applies, and omega = E V turns with the body
  /// too.
  TurnFrame frame(std::size_t body, const double* record, const Vector& increment,
                  bool symmetric) const;
  TurnFrame velocity_frame(std::size_t body, const double* record, const Vector& increment,
                           double by_velocity, bool symmetric) const;
  /// Derivative of J A + V x J V - E^T m to U, without that of m; A and V change with U by their
  /// factors.
  /// \param moment  m in the frame
  Matrix tangent(std::size_t body, const double* record, const Vector& increment, const Vector& v,
                 const Vector& a, const Vector& moment, double by_velocity, double by_acceleration,
                 bool symmetric) const;

 private:
  enum class Frame : std::uint8_t { body, world, small };
  struct Reference {
    Quat<double> q{1, 0, 0, 0};
    Vector u = Vector::Zero();
  };
  Matrix inertia(std::size_t body, const double* record) const;

  const Model<Spatial>& model_;
  std::vector<Frame> frames_;         ///< local bodies
  std::vector<Reference> reference_;  ///< owned bodies
  std::vector<Matrix> at_rest_;       ///< J_0 of owned bodies
};

}  // namespace floe
