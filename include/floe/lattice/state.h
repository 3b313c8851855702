/// \file
/// The motion of the bodies, spatial or planar. Every loop over bodies or beams is a template on
/// the traits Spatial and Planar.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "floe/base/item.h"
#include "floe/base/rotation.h"

namespace floe {

/// Six unknowns per body. A record has 16 doubles, two cache lines: displacement u, rotation q from
/// rest (w x y z), velocity v, angular velocity, angular momentum; the last two in world axes. With
/// linear kinematics q is the linearised quaternion (1, theta/2).
struct Spatial {
  static constexpr int unknowns = 6;  ///< ux uy uz, rotations about x y z
  static constexpr std::array<int, 6> components{0, 1, 2, 3, 4, 5};  ///< of x y z rx ry rz
  static constexpr int wrench = 8;  ///< doubles per wrench: one per unknown, padded
  static constexpr int translations = 3;
  static constexpr int record = 16;
  static constexpr int displacement = 0, rotation = 3, velocity = 7, angular_velocity = 10,
                       angular_momentum = 13;
  static constexpr int velocities = 6;  ///< number of rates from index `velocity` on
  static void at_rest(double* of_body) { of_body[rotation] = 1; }
};

/// Three unknowns per body, for scenes without motion out of the plane. A record has 8 doubles, one
/// cache line, which registers of four doubles can step: displacement ux uy, angle theta about z,
/// one padding; rates vx vy omega, one padding.
struct Planar {
  static constexpr int unknowns = 3;  ///< ux uy, rotation about z
  static constexpr std::array<int, 3> components{0, 1, 5};
  static constexpr int wrench = 4;
  static constexpr int translations = 2;
  static constexpr int record = 8;
  static constexpr int displacement = 0, rotation = 2, velocity = 4, angular_velocity = 6;
  static constexpr int velocities = 3;
  static void at_rest(double*) {}
};

/// The records of owned bodies and ghosts, in local order.
template <class Space>
struct State {
  double time = 0;  ///< of places [s, or pseudo-time]
  /// Time of the velocities [s]. Those of leapfrog are half a step before or after `time`; with
  /// other integrators both times are equal.
  double velocity_time = 0;
  std::vector<double> records;
  /// Largest velocity [m/s] and angular velocity [rad/s] of an owned body in the last spatial
  /// leapfrog step; other integrators leave both unchanged.
  double fastest = 0, fastest_spin = 0;

  State() = default;
  explicit State(std::size_t bodies) : records(bodies * Space::record, 0.0) {
    for (std::size_t b = 0; b < bodies; ++b) Space::at_rest(record(b));
  }
  /// Sets the time of places and velocities [s].
  void set_time(double now) { time = velocity_time = now; }
  double* record(std::size_t body) { return records.data() + body * Space::record; }
  const double* record(std::size_t body) const { return records.data() + body * Space::record; }
};

inline Vec3<double> displacement(const State<Spatial>& state, std::size_t body) {
  const double* r = state.record(body) + Spatial::displacement;
  return {r[0], r[1], r[2]};
}
inline Vec3<double> displacement(const State<Planar>& state, std::size_t body) {
  const double* r = state.record(body) + Planar::displacement;
  return {r[0], r[1], 0};
}
/// Return the rotation from rest; linearised if the kinematics are linear and the state is spatial.
inline Quat<double> rotation(const State<Spatial>& state, std::size_t body) {
  const double* r = state.record(body) + Spatial::rotation;
  return {r[0], r[1], r[2], r[3]};
}
inline Quat<double> rotation(const State<Planar>& state, std::size_t body) {
  const double half = 0.5 * state.record(body)[Planar::rotation];
  return {std::cos(half), 0, 0, std::sin(half)};
}
/// Return the rotation vector of linear kinematics.
inline Vec3<double> linear_rotation(const State<Spatial>& state, std::size_t body) {
  const double* r = state.record(body) + Spatial::rotation;
  return {2 * r[1], 2 * r[2], 2 * r[3]};
}
inline Vec3<double> linear_rotation(const State<Planar>& state, std::size_t body) {
  return {0, 0, state.record(body)[Planar::rotation]};
}
inline Vec3<double> velocity(const State<Spatial>& state, std::size_t body) {
  const double* v = state.record(body) + Spatial::velocity;
  return {v[0], v[1], v[2]};
}
inline Vec3<double> velocity(const State<Planar>& state, std::size_t body) {
  const double* v = state.record(body) + Planar::velocity;
  return {v[0], v[1], 0};
}
inline Vec3<double> angular_velocity(const State<Spatial>& state, std::size_t body) {
  const double* w = state.record(body) + Spatial::angular_velocity;
  return {w[0], w[1], w[2]};
}
inline Vec3<double> angular_velocity(const State<Planar>& state, std::size_t body) {
  return {0, 0, state.record(body)[Planar::angular_velocity]};
}

/// Returns a planar state as a spatial one.
/// \param linear  whether the rotations are linearised
State<Spatial> in_space(const State<Planar>& state, bool linear);

/// Force and moment on each local body, in the order of the unknowns [N, N m], in world axes, about
/// the centroid. The wrenches of ghosts are incomplete; their owners hold the complete ones.
template <class Space>
struct Wrenches {
  std::vector<double> values;

  explicit Wrenches(std::size_t bodies = 0) : values(bodies * Space::wrench, 0.0) {}
  double* of(std::size_t body) { return values.data() + body * Space::wrench; }
  const double* of(std::size_t body) const { return values.data() + body * Space::wrench; }
  /// Return entry k, counted over the unknowns of all bodies.
  double& at(std::size_t k) { return of(k / Space::unknowns)[k % Space::unknowns]; }
  double at(std::size_t k) const { return of(k / Space::unknowns)[k % Space::unknowns]; }
};

/// Returns a wrench as six components; those that a planar wrench lacks are 0.
template <class Space>
std::array<double, 6> components_of(const Wrenches<Space>& wrenches, std::size_t body) {
  std::array<double, 6> all{};
  for (std::size_t k = 0; k < Space::components.size(); ++k)
    item(all, Space::components[k]) = wrenches.of(body)[k];
  return all;
}
/// Adds a force [N] and a moment [N m] to a wrench; a planar wrench takes the in-plane components.
template <class Space>
void add(Wrenches<Space>& wrenches, std::size_t body, const Vec3<double>& force,
         const Vec3<double>& moment) {
  const std::array<double, 6> all{force.x, force.y, force.z, moment.x, moment.y, moment.z};
  for (std::size_t k = 0; k < Space::components.size(); ++k)
    wrenches.of(body)[k] += item(all, Space::components[k]);
}

}  // namespace floe
