#include <algorithm>
#include <cmath>
#include <cstdio>

#include "base/collectives.h"
#include "floe/base/petsc.h"
#include "floe/files/log.h"
#include "session/signals.h"
#include "simulation/build.h"

namespace floe {
namespace {

/// Boundaries that pull the ends of the sheet apart along an axis and hold nothing else.
std::vector<Boundary> pulled_ends(std::size_t axis, double displacement) {
  const std::array<const char*, 2> sets =
      axis == 0 ? std::array{"left", "right"} : std::array{"bottom", "top"};
  std::vector<Boundary> ends(2);
  for (std::size_t k = 0; k < 2; ++k) {
    ends[k].name = ends[k].set = sets[k];
    ends[k].fixed[axis] = true;
    Point3 moved{};
    moved[axis] = k == 0 ? 0 : displacement;
    ends[k].displacement = moved;
  }
  return ends;
}

/// Checks the ends. \throws InputError if a body is on both ends: a single row of bodies cannot be
/// stretched across
void require_two_ends(const Lattice& lattice, const std::vector<Boundary>& ends,
                      std::string_view side) {
  const std::vector<std::int32_t>&first = lattice.sets.at(ends[0].set),
        &second = lattice.sets.at(ends[1].set);
  if (std::find_first_of(first.begin(), first.end(), second.begin(), second.end()) != first.end())
    throw InputError(
        "fracture: calibrate: strength stretches the sheet along x and along y: sheet: " +
        std::string(side) + ": must be of more than one row of bodies");
}

/// Force along `axis` on the bodies of the first end [N]. Collective.
double force_on_first_end(const Model<Planar>& model, const Wrenches<Planar>& wrenches,
                          std::size_t axis) {
  double force = 0;
  for (const std::int32_t body : model.boundaries()[0].bodies) {
    if (body < model.part().owned) force += wrenches.of(static_cast<std::size_t>(body))[axis];
  }
  return std::abs(sum_over_ranks(force, model.part().comm));
}

/// Mean stress along an axis at which the first beam reaches its strength [Pa]. Collective.
double first_break(const Scene& scene, const Lattice& lattice, MPI_Comm comm, std::size_t axis) {
  const double across = axis == 0 ? scene.sheet.width : scene.sheet.length,
               along = axis == 0 ? scene.sheet.length : scene.sheet.width;
  Scene stretch;
  stretch.forces.beam = true;
  stretch.beam = scene.beam;
  stretch.beam.kinematics = Kinematics::linear;
  stretch.beam.damping_ratio = 0;
  stretch.boundaries = pulled_ends(axis, 1e-4 * along);
  require_two_ends(lattice, stretch.boundaries, axis == 0 ? "length" : "width");

  Model<Planar> model(lattice, comm, stretch.boundaries);
  add_forces(stretch, {}, model);
  hold_free_motions(stretch, lattice, model);
  double stress = 0, overloaded = 0;
  const RunResult result =
      run_quasistatic<Planar>(model, {1, 0}, [&](const Accepted<Planar>& accepted) {
        stress = force_on_first_end(model, accepted.wrenches, axis) / (across * scene.thickness);
        overloaded =
            overload(model.part(), model.beams()->sections(accepted.state), scene.fracture);
      });
  stop_if_asked(comm);
  if (!result.done || !(overloaded > 0))
    throw InputError("fracture: calibrate: strength: the sheet cannot be stretched along " +
                     std::string(axis == 0 ? "x: " : "y: ") + result.message);
  return stress / overloaded;
}

}  // namespace

StrengthCalibration calibrate_strength(const Scene& scene, const Lattice& lattice, MPI_Comm comm) {
  const Timed timed(Event::lattice);
  const double given = scene.fracture.tensile_strength;
  StrengthCalibration c;
  c.along_x = first_break(scene, lattice, comm, 0) / given;
  c.along_y = first_break(scene, lattice, comm, 1) / given;
  constexpr double digits = 1e6;  // rounded, so that all numbers of ranks give the same bits
  c.factor = std::round(digits * 2 / (c.along_x + c.along_y)) / digits;
  return c;
}

void strengthen(Scene& scene, const StrengthCalibration& c) {
  scene.fracture.tensile_strength *= c.factor;
  scene.fracture.shear_strength *= c.factor;
}

std::string text_of(const StrengthCalibration& c) {
  std::array<char, 160> text{};
  std::snprintf(text.data(), text.size(),
                "of the sheet %.4f along x, %.4f along y of its beams'; beams calibrated by %.6f",
                c.along_x, c.along_y, c.factor);
  return text.data();
}

}  // namespace floe
