#include "scene_model/sheet_strength.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "base/collectives.h"
#include "floe/base/item.h"
#include "floe/base/petsc.h"
#include "floe/files/log.h"
#include "fracture_laws/strengths.h"
#include "scene_model/scene_model.h"
#include "session/signals.h"

namespace floe {
namespace {

/// What a sheet is loaded by, uniformly, until its first beam breaks.
enum class Loading { tension, bending };

/// The sets of the two ends of a sheet across an axis.
std::array<const char*, 2> ends_across(std::size_t axis) {
  return axis == 0 ? std::array{"left", "right"} : std::array{"bottom", "top"};
}

/// Boundaries that pull the ends of the sheet apart along an axis, or turn them against each other
/// about the other one, and hold nothing else.
std::vector<Boundary> loaded_ends(Loading loading, std::size_t axis, double motion) {
  const std::array<const char*, 2> sets = ends_across(axis);
  std::vector<Boundary> ends(2);
  for (std::size_t k = 0; k < 2; ++k) {
    ends[k].name = ends[k].set = sets[k];
    if (loading == Loading::tension) {
      ends[k].fixed[axis] = true;
      Point3 moved{};
      moved[axis] = k == 0 ? 0 : motion;
      ends[k].displacement = moved;
    } else {
      ends[k].fixed[3 + (1 - axis)] = true;
      ends[k].angular_velocity[1 - axis] = k == 0 ? -motion : motion;  // for one second
    }
  }
  return ends;
}

/// Checks the ends. \throws InputError if a body is on both ends: a single row of bodies cannot be
/// loaded across
void require_two_ends(const Lattice& lattice, const std::vector<Boundary>& ends,
                      std::string_view side) {
  const std::vector<std::int32_t>&first = lattice.sets.at(ends[0].set),
        &second = lattice.sets.at(ends[1].set);
  if (std::find_first_of(first.begin(), first.end(), second.begin(), second.end()) != first.end())
    throw InputError(
        "fracture: calibrate and flexural_strength load the sheet along x and along y: sheet: " +
        std::string(side) + ": must be of more than one row of bodies");
}

/// Component of the wrenches on the bodies of the first end, summed [N or N m]. Collective.
template <class Space>
double reaction(const Model<Space>& model, const Wrenches<Space>& wrenches, std::size_t component) {
  double sum = 0;
  for (const std::int32_t body : model.boundaries()[0].bodies) {
    if (body < model.part().owned) sum += wrenches.of(static_cast<std::size_t>(body))[component];
  }
  return std::abs(sum_over_ranks(sum, model.part().comm));
}

/// Per local beam: whether it is away from the turned ends, where the moments on cells of many
/// sizes are not uniform.
std::vector<std::uint8_t> beams_away(const Lattice& lattice, const Part& part,
                                     const std::vector<Boundary>& ends) {
  std::vector<std::uint8_t> at_end(lattice.bodies.position.size(), 0);
  for (const Boundary& end : ends) {
    for (const std::int32_t body : lattice.sets.at(end.set)) item(at_end, body) = 1;
  }
  std::vector<std::uint8_t> away;
  away.reserve(part.beams.bodies.size());
  for (const auto& [i, j] : part.beams.bodies)
    away.push_back(item(at_end, item(part.global, i)) == 0 &&
                   item(at_end, item(part.global, j)) == 0);
  return away;
}

/// Largest s of the beams away from the turned ends; of all, if there are none. Collective.
double worst_away(const Part& part, std::vector<BeamSection> sections,
                  const std::vector<std::uint8_t>& away, const FractureOptions& fracture) {
  const double of_all = overload(part, sections, fracture);
  for (std::size_t m = 0; m < sections.size(); ++m) {
    if (away[m] == 0) sections[m] = {};
  }
  const double inside = overload(part, sections, fracture);
  return inside > 0 ? inside : of_all;
}

/// Nominal stress at which the first beam of the sheet reaches its strength [Pa]: the mean stress
/// in tension, 6M/(b h^2) in bending, there of the beams away from the ends. Collective.
template <class Space>
double first_break(const Scene& scene, const Lattice& lattice, MPI_Comm comm, Loading loading,
                   std::size_t axis) {
  const bool pulls = loading == Loading::tension;
  const double across = axis == 0 ? scene.sheet.width : scene.sheet.length,
               along = axis == 0 ? scene.sheet.length : scene.sheet.width;
  const double h = scene.thickness, section = across * h * (pulls ? 1 : h / 6);
  Scene test;
  test.forces.beam = true;
  test.beam = scene.beam;
  test.beam.kinematics = Kinematics::linear;
  test.beam.damping_ratio = 0;
  constexpr double strain = 1e-4;
  test.boundaries = loaded_ends(loading, axis, strain * along / (pulls ? 1 : h));
  require_two_ends(lattice, test.boundaries, axis == 0 ? "length" : "width");

  Model<Space> model(lattice, comm, test.boundaries);
  add_forces(test, {}, model);
  hold_free_motions(test, lattice, model);
  const std::vector<std::uint8_t> away =
      pulls ? std::vector<std::uint8_t>(model.part().beams.bodies.size(), 1)
            : beams_away(lattice, model.part(), test.boundaries);
  const std::size_t component = pulls ? axis : 3 + (1 - axis);
  double stress = 0, worst = 0;
  const RunResult result =
      run_quasistatic<Space>(model, {1, 0}, [&](const Accepted<Space>& accepted) {
        stress = reaction(model, accepted.wrenches, component) / section;
        worst =
            worst_away(model.part(), model.beams()->sections(accepted.state), away, scene.fracture);
      });
  stop_if_asked(comm);
  if (!result.done || !(worst > 0))
    throw InputError("fracture: calibrate: strength: the sheet cannot be " +
                     std::string(pulls ? "stretched along " : "bent along ") +
                     (axis == 0 ? "x: " : "y: ") + result.message);
  return stress / worst;
}

/// Strengths along x and y over a given one. Collective.
template <class Space>
StrengthCalibration::Test strengths_of_sheet(const Scene& scene, const Lattice& lattice,
                                             MPI_Comm comm, Loading loading, double given) {
  return {first_break<Space>(scene, lattice, comm, loading, 0) / given,
          first_break<Space>(scene, lattice, comm, loading, 1) / given};
}

/// Rounds a factor, so that all numbers of ranks give the same bits.
double rounded(double factor) {
  constexpr double digits = 1e6;
  return std::round(digits * factor) / digits;
}

}  // namespace

StrengthCalibration calibrate_strength(const Scene& scene, const Lattice& lattice, MPI_Comm comm) {
  const Timed timed(Event::lattice);
  const FractureOptions& given = scene.fracture;
  StrengthCalibration c;
  if (given.calibrate) {
    c.tension =
        strengths_of_sheet<Planar>(scene, lattice, comm, Loading::tension, given.tensile_strength);
    c.factor = rounded(2 / (c.tension->along_x + c.tension->along_y));
  }
  Scene calibrated = scene;
  calibrated.fracture.flexural_strength =
      given.flexural_strength > 0 ? given.flexural_strength : given.tensile_strength;
  strengthen(calibrated, c);
  c.bending = strengths_of_sheet<Spatial>(calibrated, lattice, comm, Loading::bending,
                                          calibrated.fracture.flexural_strength);
  c.bending_factor = rounded((c.bending.along_x + c.bending.along_y) / 2);
  return c;
}

void strengthen(Scene& scene, const StrengthCalibration& c) {
  FractureOptions& fracture = scene.fracture;
  for (double* strength :
       {&fracture.tensile_strength, &fracture.shear_strength, &fracture.compressive_strength})
    *strength *= c.factor;
  fracture.bending_factor = c.bending_factor;
}

std::string text_of(const StrengthCalibration& c) {
  std::array<char, 200> text{};
  int length = 0;
  if (c.tension)
    length = std::snprintf(text.data(), text.size(),
                           "of the sheet %.4f along x, %.4f along y of its beams'; beams "
                           "calibrated by %.6f; ",
                           c.tension->along_x, c.tension->along_y, c.factor);
  std::snprintf(text.data() + length, text.size() - static_cast<std::size_t>(length),
                "in bending %.4f along x, %.4f along y of the given one; bending weighed by %.6f",
                c.bending.along_x, c.bending.along_y, c.bending_factor);
  return text.data();
}

}  // namespace floe
