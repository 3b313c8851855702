/// \file
/// The tension test of a square sheet (model.md, "Tension test"; paper, "Effective Young's
/// Modulus").
#pragma once

#include "floe/scene.h"
#include "support/static_solution.h"

namespace floe::test {

/// Left bodies held in x, right bodies moved by strain times the length, nothing else constrained.
inline Scene tension_scene(double length, double thickness, double element_size, std::uint64_t seed,
                           double strain = 0.001) {
  Scene scene;
  scene.has_sheet = true;
  scene.sheet = {length, length, element_size, seed, Relaxation::lloyd, 150, 0};
  scene.thickness = thickness;
  scene.forces.beam = true;
  Boundary left, right;
  left.name = left.set = "left";
  right.name = right.set = "right";
  left.fixed[0] = right.fixed[0] = true;
  right.displacement = Point3{strain * length, 0, 0};
  right.ramp.seconds = 1;
  scene.boundaries = {left, right};
  return scene;
}

/// E/Eb with E = F/(A0 eps): F the beams' forces on the left bodies, A0 = L h.
inline double young_ratio(const Scene& scene, const Lattice& lattice, const StaticSolution& s) {
  double force = 0;
  for (const std::int32_t body : lattice.sets.at("left"))
    force += s.wrenches.of(static_cast<std::size_t>(body))[0];
  const double strain = (*scene.boundaries[1].displacement)[0] / scene.sheet.length;
  return force / (scene.sheet.width * scene.thickness * strain * scene.ice.young);
}

}  // namespace floe::test
