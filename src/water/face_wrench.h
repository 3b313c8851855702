/// \file
/// Drag on the faces of a body as it was found, and as it follows the body's velocities.
#pragma once

#include <array>
#include <cstddef>
#include <utility>

#include "floe/base/rotation.h"

namespace floe {

/// Drag on the faces of a body as it was found, with its derivative C = (C_vv, C_vw; C_vw^T, C_ww)
/// to the body's velocity v and angular velocity w, times -1.
struct FaceWrench {
  using Matrix = std::array<Vec3<double>, 3>;  ///< by rows

  Vec3<double> force{0, 0, 0}, moment{0, 0, 0};
  Vec3<double> against{0, 0, 0}, spin{0, 0, 0};  ///< velocity of the water less the body's; w
  Matrix vv{}, vw{}, ww{};

  /// Adds the derivative D of a force at r.
  void add_slope(const Vec3<double>& r, const Matrix& d) {
    const auto times = [&d](const Vec3<double>& u) {
      return Vec3<double>{dot(d[0], u), dot(d[1], u), dot(d[2], u)};
    };
    // The body's velocity at r is v + w x r, the moment of a force f there r x f.
    const std::array<Vec3<double>, 3> turned{times({0, -r.z, r.y}), times({r.z, 0, -r.x}),
                                             times({-r.y, r.x, 0})};
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3<double> couple = cross(r, turned[k]);
      for (std::size_t row = 0; row < 3; ++row) {
        vw[row][k] += turned[k][row];
        ww[row][k] += couple[row];
      }
      vv[k] = vv[k] + d[k];
    }
  }
  /// The wrench at other velocities, to first order.
  std::pair<Vec3<double>, Vec3<double>> at(const Vec3<double>& against_now,
                                           const Vec3<double>& spin_now) const {
    const Vec3<double> faster = against - against_now, turns = spin_now - spin;
    Vec3<double> f = force, m = moment;
    for (std::size_t k = 0; k < 3; ++k) {
      f[k] -= dot(vv[k], faster) + dot(vw[k], turns);
      m = m - faster[k] * vw[k];
      m[k] -= dot(ww[k], turns);
    }
    return {f, m};
  }
  static constexpr std::size_t numbers = 39;
  std::array<double*, numbers> all() {
    std::array<double*, numbers> all{};
    std::size_t n = 0;
    for (Vec3<double>* v : {&force, &moment, &against, &spin, &vv[0], &vv[1], &vv[2], &vw[0],
                            &vw[1], &vw[2], &ww[0], &ww[1], &ww[2]})
      for (double* x : {&v->x, &v->y, &v->z}) all[n++] = x;
    return all;
  }
};

}  // namespace floe
