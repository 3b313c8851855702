// The paper's bending test as the paper ran it: explicitly, with Stokes drag, until the sheet rests
// (model.md, "Bending on water" and "Explicit dynamics"; paper, "Bending of an Ice Sheet").
#include <algorithm>
#include <cmath>

#include "support/bending.h"
#include "support/explicit_run.h"
#include "support/record.h"

namespace floe::test {
namespace {

/// Along X = 0, 0 <= Y <= L/2, where the paper draws its profiles: the largest difference of two
/// deflections over Wyman's w0.
Departure between(const Scene& scene, const Lattice& lattice, const StaticSolution& rest,
                  const State<Spatial>& stepped) {
  const double w0 = Wyman::of_material(scene).centre;
  Departure d;
  for (std::size_t b = 0; b < lattice.bodies.position.size(); ++b) {
    const auto& [x, y, z] = lattice.bodies.position[b];
    if (std::abs(x) > scene.sheet.element_size / 2 || y < 0) continue;
    const double sunk = displacement(rest.last(), b).z - displacement(rest.first(), b).z;
    d.largest = std::max(d.largest, std::abs(displacement(stepped, b).z - sunk) / w0);
    ++d.points;
  }
  return d;
}

TEST(PaperBending, ProfileAtRestIsTheQuasiStaticOne) {
  const double length = full_form() ? 80 : 20, h = 0.5;
  Scene scene = bending_scene(length, h, 3 * h);
  const Lattice lattice = mesh_of(scene);
  const StaticSolution rest = solve_static(scene, lattice);
  scene.beam.damping_ratio = 1;
  scene.forces.drag = true;
  // Critical for heave: c = 2 sqrt(rho_w g rho_i h) per area.
  scene.drag.linear =
      2 * std::sqrt(scene.water_density * scene.gravity * scene.ice.density * scene.thickness);
  scene.time.end = 4;
  const ExplicitRun run = run_scene(scene, lattice, 0);
  ASSERT_TRUE(run.result.done) << run.result.message;
  const Departure d = between(scene, lattice, rest, run.state);
  EXPECT_GT(d.points, length / (2 * scene.sheet.element_size) - 2);
  verify(
      {.section = "Explicit dynamics",
       .quantity =
           text("bending, L=%g h=0.5 l=3h: profile from the quasi-static one, over w0", length),
       .value = d.largest,
       .reference = 0,
       .tolerance = 0.01,
       .note = text("%d bodies along X = 0 after %g s, %ld steps; zeta = 1, Stokes drag critical "
                    "for heave",
                    d.points, scene.time.end, static_cast<long>(run.result.steps))});
}

}  // namespace
}  // namespace floe::test
