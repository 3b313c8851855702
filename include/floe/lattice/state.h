/// \file
/// Motion of the bodies, spatial or planar. Every loop over bodies or beams is a template on these
/// traits.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "floe/base/rotation.h"

namespace floe {

/// Six unknowns per body. A record of 16 doubles, two cache lines: displacement u, rotation q from
/// rest (w x y z), velocity v, angular velocity, angular momentum; the last two in world axes. With
/// linear kinematics q is the linearised quaternion (1, theta/2).
struct Spatial {
  static constexpr int unknowns = 6;  ///< ux uy uz, rotations about x y z
  static constexpr int wrench = 8;    ///< doubles per wrench: the unknowns' number, padded
  static constexpr int translations = 3;
  static constexpr int record = 16;
  static constexpr int displacement = 0, rotation = 3, velocity = 7, angular_velocity = 10,
                       angular_momentum = 13;
  static constexpr int rotation_size = 4;
  static void at_rest(double* record) { record[rotation] = 1; }
};

/// Three unknowns per body, for scenes where nothing moves out of plane: ux uy theta, vx vy omega,
/// two of padding.
struct Planar {
  static constexpr int unknowns = 3;
  static constexpr int wrench = 4;
  static constexpr int translations = 2;
  static constexpr int record = 8;
  static constexpr int displacement = 0, rotation = 2, velocity = 3, angular_velocity = 5;
  static constexpr int rotation_size = 1;
  static void at_rest(double*) {}
};

/// Records of owned bodies and ghosts, in local order, at one time [s, or pseudo-time].
template <class Space>
struct State {
  double time = 0;
  std::vector<double> records;

  State() = default;
  explicit State(std::size_t bodies) : records(bodies * Space::record, 0.0) {
    for (std::size_t b = 0; b < bodies; ++b) Space::at_rest(record(b));
  }
  double* record(std::size_t body) { return records.data() + body * Space::record; }
  const double* record(std::size_t body) const { return records.data() + body * Space::record; }
};

inline Vec3<double> displacement(const State<Spatial>& state, std::size_t body) {
  const double* r = state.record(body) + Spatial::displacement;
  return {r[0], r[1], r[2]};
}
inline Quat<double> rotation(const State<Spatial>& state, std::size_t body) {
  const double* r = state.record(body) + Spatial::rotation;
  return {r[0], r[1], r[2], r[3]};
}

/// Force and moment on each local body, in the order of the unknowns [N, N m]; world axes, about
/// the centroid. Those of ghosts are left unfinished: their owners have them.
template <class Space>
struct Wrenches {
  std::vector<double> values;

  explicit Wrenches(std::size_t bodies = 0) : values(bodies * Space::wrench, 0.0) {}
  double* of(std::size_t body) { return values.data() + body * Space::wrench; }
  const double* of(std::size_t body) const { return values.data() + body * Space::wrench; }
  /// Entry of unknown k, counted through all bodies.
  double& at(std::size_t k) { return of(k / Space::unknowns)[k % Space::unknowns]; }
  double at(std::size_t k) const { return of(k / Space::unknowns)[k % Space::unknowns]; }
};

}  // namespace floe
