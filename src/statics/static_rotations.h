/// \file
/// Rotations of bodies as unknowns of statics: the running sum theta of rotation increments.
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "beams/beam_force.h"
#include "floe/lattice/state.h"

namespace floe {

/// Rotations of a rank's owned bodies.
template <class Space>
class StaticRotations;

/// q = exp(theta - theta_ref) q_ref. The reference moves to the present state whenever a tangent is
/// formed, so that increments are spins there. With linear kinematics q = (1, theta/2).
template <>
class StaticRotations<Spatial> {
 public:
  StaticRotations(std::size_t bodies, Kinematics kinematics)
      : linear_(kinematics == Kinematics::linear), reference_(bodies) {}

  /// Writes a body's rotation into its record. \param t  theta [rad]
  void take(std::size_t body, const std::array<double, 3>& t, double* record) const {
    double* q = record + Spatial::rotation;
    if (linear_) {
      q[0] = 1;
      for (std::size_t k = 0; k < 3; ++k) q[1 + k] = 0.5 * t[k];
      return;
    }
    const auto& [from, at] = reference_[body];
    const Vec3<double> spin{t[0] - at[0], t[1] - at[1], t[2] - at[2]};
    const Quat<double> now = normalised(product(exp_rotation(spin), from));
    q[0] = now.w, q[1] = now.x, q[2] = now.y, q[3] = now.z;
  }
  /// Moves a body's reference to theta and to the record's rotation, which must be that of theta.
  void rebase(std::size_t body, const std::array<double, 3>& t, const double* record) {
    const double* q = record + Spatial::rotation;
    reference_[body] = {{q[0], q[1], q[2], q[3]}, t};
  }

 private:
  struct Reference {
    Quat<double> q{1, 0, 0, 0};
    std::array<double, 3> theta{};
  };
  bool linear_;
  std::vector<Reference> reference_;
};

/// In the plane the unknown is the angle, which needs no reference.
template <>
class StaticRotations<Planar> {
 public:
  StaticRotations(std::size_t /*bodies*/, Kinematics) {}
  void take(std::size_t /*body*/, const std::array<double, 1>& t, double* record) const {
    record[Planar::rotation] = t[0];
  }
  void rebase(std::size_t /*body*/, const std::array<double, 1>&, const double*) {}
};

}  // namespace floe
