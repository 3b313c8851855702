/// \file
/// Sheets whose stable step is measured.
#pragma once

#include "support/tension.h"
#include "support/triangles.h"

namespace floe::test {

inline Lattice random_sheet() { return mesh_of(tension_scene(10, 0.5, 1.1, 5)); }

inline Lattice regular_sheet() {
  const Ice ice;
  const double l = 1.2, h = 0.6;
  Lattice lattice = triangles(5, l, h, ice, 5.0 / 6, Torsion::saint_venant).lattice;
  for (std::size_t b = 0; b < lattice.bodies.mass.size(); ++b) {
    const double m = lattice.bodies.mass[b], flat = m * (5 * l * l / 72 + h * h / 12);
    lattice.bodies.inertia[b] = {flat, flat, m * 5 * l * l / 36};
  }
  return lattice;
}

/// One facet a hundredth as wide as it was, and a body of a ten thousandth of its neighbours' mass.
inline Lattice extreme_sheet() {
  Lattice lattice = random_sheet();
  const auto m = lattice.beams.bodies.size() / 2;
  lattice.beams.area[m] *= 1e-2, lattice.beams.inertia_y[m] *= 1e-2;
  lattice.beams.inertia_z[m] *= 1e-6, lattice.beams.torsion[m] *= 1e-6;
  const auto b = lattice.bodies.mass.size() / 3;
  lattice.bodies.mass[b] *= 1e-4;
  lattice.bodies.inertia[b] = 1e-4 * lattice.bodies.inertia[b];
  return lattice;
}

}  // namespace floe::test
