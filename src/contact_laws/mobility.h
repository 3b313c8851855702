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

/// The bodies A and B of a contact, as rigid bodies.
struct Mobility {
  InverseInertia a{}, b{};
  Triad<double> axes_a{}, axes_b{};  ///< of the bodies in the world
  Vec3<double> apart{};              ///< x_A - x_B [m]

  /// Returns 1/m_eff = 1/m_a + 1/m_b + (r_a x d).I_a^-1 (r_a x d) + (r_b x d).I_b^-1 (r_b x d),
  /// the relative acceleration at a point per force, along the force [1/kg].
  /// \param r  the point, from x_A [m]
  /// \param d  a unit vector
  double along(const Vec3<double>& r, const Vec3<double>& d) const {
    return a.mass + b.mass + turning(a, axes_a, cross(r, d)) +
           turning(b, axes_b, cross(r + apart, d));
  }
  /// Returns d.(I_a^-1 + I_b^-1) d of a unit vector, the relative angular acceleration per couple
  /// [1/(kg m^2)].
  double about(const Vec3<double>& d) const {
    return turning(a, axes_a, d) + turning(b, axes_b, d);
  }

 private:
  static double turning(const InverseInertia& body, const Triad<double>& axes,
                        const Vec3<double>& v) {
    const Vec3<double> u = axes.to_local(v);
    return body.moments.x * u.x * u.x + body.moments.y * u.y * u.y + body.moments.z * u.z * u.z;
  }
};

}  // namespace floe
