/// \file
/// Chains of bodies joined by beams, built in code as floe.lattice builds them.
#pragma once

#include <cmath>
#include <numbers>
#include <vector>

#include "floe/lattice/lattice.h"

namespace floe::test {

/// Section and material of a frame's beams.
struct FrameSection {
  double area = 1, inertia_y = 1.0 / 12, inertia_z = 1.0 / 12, torsion = 1.0 / 6;
  double young = 1e7, shear_modulus = 5e6, shear_factor = 5.0 / 6;
};

/// Bodies at `points`, neighbours joined by beams with the same axis 2 in the world (made
/// orthogonal to the beam). Masses and inertias are of no account in statics. Sets `root` (first)
/// and `tip` (last).
inline Lattice frame(const std::vector<Point3>& points, const FrameSection& section,
                     const std::vector<Point3>& axis_y) {
  Lattice lattice;
  const auto n = static_cast<std::int32_t>(points.size());
  for (std::int32_t b = 0; b < n; ++b) {
    lattice.bodies.position.push_back(points[static_cast<std::size_t>(b)]);
    lattice.bodies.orientation.push_back({1, 0, 0, 0});
    lattice.bodies.mass.push_back(1);
    lattice.bodies.inertia.push_back({1, 1, 1});
  }
  for (std::int32_t m = 0; m + 1 < n; ++m) {
    const Point3 &a = points[static_cast<std::size_t>(m)],
                 &b = points[static_cast<std::size_t>(m) + 1];
    Beams& beams = lattice.beams;
    beams.bodies.push_back({m, m + 1});
    beams.area.push_back(section.area);
    beams.inertia_y.push_back(section.inertia_y);
    beams.inertia_z.push_back(section.inertia_z);
    beams.torsion.push_back(section.torsion);
    beams.length.push_back(std::hypot(b[0] - a[0], b[1] - a[1], b[2] - a[2]));
    beams.young.push_back(section.young);
    beams.shear_modulus.push_back(section.shear_modulus);
    beams.shear_factor.push_back(section.shear_factor);
    beams.axis_y.push_back(axis_y[static_cast<std::size_t>(m)]);
  }
  lattice.sets = {{"root", {0}}, {"tip", {n - 1}}};
  return lattice;
}

/// From the origin along the unit vector `direction`; axis 2 of every beam is `axis_y`.
inline Lattice straight_frame(double length, int elements, const FrameSection& section,
                              const Point3& direction = {1, 0, 0},
                              const Point3& axis_y = {0, 1, 0}) {
  std::vector<Point3> points;
  for (int b = 0; b <= elements; ++b) {
    const double s = length * b / elements;
    points.push_back(s * direction);
  }
  return frame(points, section, std::vector<Point3>(static_cast<std::size_t>(elements), axis_y));
}

/// On a circular arc in the x-y plane from the origin, at first along x, bending to +y; axis 2 lies
/// in the plane.
inline Lattice arc_frame(double radius, double angle, int elements, const FrameSection& section) {
  std::vector<Point3> points, axis_y;
  for (int b = 0; b <= elements; ++b) {
    const double phi = angle * b / elements, middle = angle * (b + 0.5) / elements;
    points.push_back({radius * std::sin(phi), radius * (1 - std::cos(phi)), 0});
    if (b < elements) axis_y.push_back({-std::sin(middle), std::cos(middle), 0});
  }
  return frame(points, section, axis_y);
}

}  // namespace floe::test
