/// \file
/// A soft bar that turns, bends and flies: large rotations without a hold.
#pragma once

#include "support/dynamics.h"

namespace floe::test {

/// A soft bar along x that spins about an oblique axis, is bent by its velocities, and flies.
inline Lattice flying_bar(int elements, double bending_velocity) {
  const double length = 10;
  FrameSection section;
  section.area = 0.6, section.inertia_y = 0.05, section.inertia_z = 0.08, section.torsion = 0.07;
  section.young = 1e5, section.shear_modulus = 4e4;
  Lattice lattice = straight_frame(length, elements, section);
  give_mass(lattice, section, 1.0);
  const Vec3<double> spin{0.4, -1.0, 2.5}, flight{0.7, -0.3, 0.5};
  for (const Point3& x : lattice.bodies.position) {
    const double s = 2 * x.x / length - 1;  // -1 to 1
    const Vec3<double> arm{x.x - 0.5 * length, x.y, x.z};
    const Vec3<double> v = flight + cross(spin, arm);
    // As the first bending mode of a free bar, roughly: s^2 - 1/3 has no momentum.
    const double bend = bending_velocity * (s * s - 1.0 / 3), slope = bending_velocity * 4 * s;
    lattice.bodies.velocity.push_back({v.x, v.y + bend, v.z - 0.5 * bend});
    lattice.bodies.angular_velocity.push_back(
        {spin.x, spin.y + 0.5 * slope / length, spin.z + slope / length});
  }
  return lattice;
}

}  // namespace floe::test
