// Small lattices for tests.
#pragma once

#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include "floe/base/rotation.h"
#include "floe/lattice/lattice.h"
#include "support/random.h"

namespace floe::test {

/// Bodies at the given places, joined by equal beams with a section of different moments about each
/// axis. Axis 2 of a beam is level if the beam is not upright. Sets: first, last, all.
inline Lattice frame(const std::vector<Point3>& places,
                     const std::vector<std::array<std::int32_t, 2>>& pairs) {
  Lattice f;
  const auto n = static_cast<std::int32_t>(places.size());
  for (const Point3& x : places) {
    f.bodies.position.push_back(x);
    f.bodies.orientation.push_back({1, 0, 0, 0});
    f.bodies.mass.push_back(2);
    f.bodies.inertia.push_back({0.3, 0.4, 0.5});
  }
  Beams& b = f.beams;
  for (const auto& [i, j] : pairs) {
    const Vec3<double> e =
        places[static_cast<std::size_t>(j)] - places[static_cast<std::size_t>(i)];
    const double flat = std::hypot(e.x, e.y);
    b.bodies.push_back({i, j});
    b.area.push_back(0.5), b.inertia_y.push_back(0.04), b.inertia_z.push_back(0.01);
    b.torsion.push_back(0.02), b.length.push_back(std::sqrt(dot(e, e)));
    b.young.push_back(1000), b.shear_modulus.push_back(400), b.shear_factor.push_back(0.8);
    b.axis_y.push_back(flat > 0 ? Point3{-e.y / flat, e.x / flat, 0} : Point3{0, 1, 0});
  }
  f.sets["first"] = {0};
  f.sets["last"] = {n - 1};
  f.sets["all"].resize(static_cast<std::size_t>(n));
  std::iota(f.sets["all"].begin(), f.sets["all"].end(), 0);
  return f;
}

/// n bodies in a row along x, 1 m apart, neighbours joined.
inline Lattice row(std::int32_t n) {
  std::vector<Point3> places;
  std::vector<std::array<std::int32_t, 2>> pairs;
  for (std::int32_t k = 0; k < n; ++k) {
    places.push_back({static_cast<double>(k), 0, 0});
    if (k > 0) pairs.push_back({k - 1, k});
  }
  return frame(places, pairs);
}

/// A meshed sheet of 0.5 m thickness, floating at its draft in water of 1010 kg/m^3 or with its
/// mid-plane at z = 0; in the mesh's own order.
inline Lattice sheet(double length, double width, double element_size, bool floating = false) {
  SheetPlan plan;
  plan.length = length, plan.width = width, plan.element_size = element_size, plan.iterations = 20;
  SheetSection section;
  section.thickness = 0.5;
  if (floating) section.mid_plane = section.thickness * (0.5 - section.ice.density / 1010);
  Lattice s = make_sheet(tessellate(plan, MPI_COMM_SELF), section);
  auto& all = s.sets["all"];
  all.resize(s.bodies.position.size());
  std::iota(all.begin(), all.end(), 0);
  return s;
}

}  // namespace floe::test
