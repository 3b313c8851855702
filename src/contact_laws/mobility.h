/// \file
/// What two bodies oppose to a change of their relative motion.
#pragma once

#include "floe/base/rotation.h"

namespace floe {

/// Inverse mass and moments of inertia of a body; zeros for an obstacle.
struct InverseInertia {
  double mass = 0;         ///< [1/kg]
  Vec3<double> moments{};  ///< about the axes of the body [1/(kg m^2)]
};

/// A symmetric matrix of three rows.
template <class T>
struct SymmetricMatrixOf {
  T xx = 0, yy = 0, zz = 0, xy = 0, xz = 0, yz = 0;

  /// Returns the matrix with principal values along axes.
  static constexpr SymmetricMatrixOf along(const Triad<T>& axes, const Vec3<T>& principal) {
    const auto& [e, f, g] = axes;
    const Vec3<T> a = principal.x * e, b = principal.y * f, c = principal.z * g;
    return {.xx = a.x * e.x + b.x * f.x + c.x * g.x,
            .yy = a.y * e.y + b.y * f.y + c.y * g.y,
            .zz = a.z * e.z + b.z * f.z + c.z * g.z,
            .xy = a.x * e.y + b.x * f.y + c.x * g.y,
            .xz = a.x * e.z + b.x * f.z + c.x * g.z,
            .yz = a.y * e.z + b.y * f.z + c.y * g.z};
  }
  constexpr Vec3<T> operator*(const Vec3<T>& v) const {
    return {xx * v.x + xy * v.y + xz * v.z, xy * v.x + yy * v.y + yz * v.z,
            xz * v.x + yz * v.y + zz * v.z};
  }
  constexpr SymmetricMatrixOf operator+(const SymmetricMatrixOf& m) const {
    return {xx + m.xx, yy + m.yy, zz + m.zz, xy + m.xy, xz + m.xz, yz + m.yz};
  }
  constexpr T trace() const { return xx + yy + zz; }
};
using SymmetricMatrix = SymmetricMatrixOf<double>;

/// A body as a contact moves it: inverse mass [1/kg] and inverse tensor of inertia in the world
/// [1/(kg m^2)]; zeros for an obstacle.
template <class T>
struct BodyMobilityOf {
  T mass = 0;
  SymmetricMatrixOf<T> turning{};
};
using BodyMobility = BodyMobilityOf<double>;

/// The bodies A and B of a contact, as rigid bodies.
template <class T>
struct MobilityOf {
  BodyMobilityOf<T> a{}, b{};
  Vec3<T> apart{};  ///< x_A - x_B [m]

  /// Returns 1/m_eff = 1/m_a + 1/m_b + (r_a x d).I_a^-1 (r_a x d) + (r_b x d).I_b^-1 (r_b x d),
  /// the relative acceleration at a point per force, along the force [1/kg].
  /// \param r  the point, from x_A [m]
  /// \param d  a unit vector
  constexpr T along(const Vec3<T>& r, const Vec3<T>& d) const {
    return a.mass + b.mass + form(a, cross(r, d)) + form(b, cross(r + apart, d));
  }
  /// Returns the mean of along() over the directions across a unit vector [1/kg]. Over three
  /// directions at right angles the terms of a body add up to tr(I^-1) r.r - r.I^-1 r.
  constexpr T across(const Vec3<T>& r, const Vec3<T>& d) const {
    return 0.5 * (3.0 * (a.mass + b.mass) + all(a, r) + all(b, r + apart) - along(r, d));
  }
  /// Returns I_a^-1 + I_b^-1, the relative angular acceleration per couple [1/(kg m^2)].
  constexpr SymmetricMatrixOf<T> turning() const { return a.turning + b.turning; }

 private:
  static constexpr T form(const BodyMobilityOf<T>& body, const Vec3<T>& v) {
    return dot(v, body.turning * v);
  }
  static constexpr T all(const BodyMobilityOf<T>& body, const Vec3<T>& r) {
    return body.turning.trace() * dot(r, r) - form(body, r);
  }
};
using Mobility = MobilityOf<double>;

}  // namespace floe
