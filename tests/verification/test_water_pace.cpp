// The pace of the water (`water: pace`): what is computed every k-th step against what is computed
// in every step (model.md, "Water").

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <tuple>
#include <vector>

#include "scene_model/scene_model.h"
#include "support/box.h"
#include "support/dynamics.h"
#include "support/lattices.h"
#include "support/record.h"
#include "support/states.h"

namespace floe::test {
namespace {

constexpr const char* section_name = "Pace of the water";
constexpr double side = 4, thickness = 1, ice = 920, water = 1010, gravity = 9.81;
constexpr double area = side * side, mass = ice * area * thickness;
constexpr double floating = thickness * (0.5 - ice / water);  // height of the centroid [m]
constexpr double dt = 2e-4;

Lattice block(double height, const Point3& velocity, const Point3& spin = {}) {
  return box({side, side, thickness}, ice, height, velocity, spin);
}

Scene afloat(int pace) {
  Scene scene;
  scene.integrator = Integrator::explicit_;
  scene.forces.gravity = scene.forces.buoyancy = true;
  scene.water_pace = pace;
  return scene;
}

struct Course {
  std::vector<double> time;
  std::vector<std::array<double, Spatial::record>> first_body;
  std::vector<double> kinetic, strain, drag, external, balance_error;

  double worst_error() const {
    double worst = 0;
    for (const double e : balance_error) worst = std::max(worst, std::abs(e));
    return worst;
  }
  std::vector<double> history(std::size_t component) const {
    std::vector<double> values;
    for (const auto& record : first_body) values.push_back(record[component]);
    return values;
  }
  /// Largest distance of the first body's places from those of another course [m].
  double distance(const Course& other) const {
    double largest = 0;
    for (std::size_t k = 0; k < time.size(); ++k) {
      const auto &a = first_body[k], &b = other.first_body[k];
      largest = std::max(largest, std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]));
    }
    return largest;
  }
};

Course run(const Scene& scene, const Lattice& lattice, double end, double every, double step = dt) {
  Model<Spatial> model(lattice, PETSC_COMM_SELF, {});
  add_forces(scene, {}, model);
  ExplicitOptions options;
  options.end = end;
  options.dt = step;
  options.history = every;
  Course r;
  const RunResult result = run_explicit(model, options, [&](const Accepted<Spatial>& a) {
    r.time.push_back(a.state.time);
    std::array<double, Spatial::record> record{};
    std::copy_n(a.state.record(0), Spatial::record, record.begin());
    r.first_body.push_back(record);
    const auto take = [](const auto& columns, const std::string& wanted, auto& values) {
      for (const auto& [name, value] : columns)
        if (name == wanted) values.push_back(value);
    };
    take(a.columns, "energy_balance_error", r.balance_error);
    take(a.columns, "energy_kinetic", r.kinetic);
    take(a.forces, "energy_strain", r.strain);
    take(a.forces, "energy_drag", r.drag);
    take(a.forces, "energy_external", r.external);
  });
  EXPECT_TRUE(result.done) << result.message;
  return r;
}

/// Angular frequency of an oscillation about 0, from its first to its last passage through 0.
double frequency(const std::vector<double>& time, const std::vector<double>& value) {
  std::vector<double> passages;
  for (std::size_t k = 1; k + 1 < time.size(); ++k) {
    if ((value[k] < 0) == (value[k + 1] < 0)) continue;
    passages.push_back(time[k] + (time[k + 1] - time[k]) * value[k] / (value[k] - value[k + 1]));
  }
  EXPECT_GT(passages.size(), 10U);
  return std::numbers::pi * static_cast<double>(passages.size() - 1) /
         (passages.back() - passages.front());
}

TEST(WaterPace, HeaveAndRollForAMinute) {
  const Lattice lattice = block(floating, {0, 0, 0.03}, {0.01, 0.004, 0});
  const Course each = run(afloat(1), lattice, 60, 2e-2), tenth = run(afloat(10), lattice, 60, 2e-2);
  for (const auto& [name, component] : {std::pair{"heave", 2U}, {"roll", 4U}}) {
    verify({.section = section_name,
            .quantity = "frequency of " + std::string(name) + " of a block at pace 10 over 1, -1",
            .value = frequency(tenth.time, tenth.history(component)) /
                         frequency(each.time, each.history(component)) -
                     1,
            .reference = 0.0,
            .tolerance = 1e-7});
  }
  verify(
      {.section = section_name,
       .quantity = "power that a pace of 10 gives to that block: largest error of the ledger "
                   "over 60 s",
       .value = tenth.worst_error() / 60,
       .reference = 0.0,
       .tolerance = 1e-6,
       .unit = "W",
       .note = "it swings with " + std::to_string(0.5 * mass * 0.03 * 0.03).substr(0, 4) + " J"});
}

/// A block whose edges dip in and out: its waterplane changes.
TEST(WaterPace, ErrorIsOfTheSecondOrder) {
  const Lattice lattice = block(floating + 0.1, {0, 0, 0}, {0.25, 0.17, 0});
  const Course each = run(afloat(1), lattice, 4, 1e-2);
  const double ten = run(afloat(10), lattice, 4, 1e-2).distance(each),
               twenty = run(afloat(20), lattice, 4, 1e-2).distance(each);
  EXPECT_GT(ten, 0);
  EXPECT_LT(ten, 1e-5);
  verify({.section = section_name,
          .quantity = "order in k of the way of a rolling block",
          .value = std::log2(twenty / ten),
          .reference = 2.0,
          .tolerance = 0.25});
}

/// Drag keeps taking energy by the present velocity.
TEST(WaterPace, DragDecays) {
  Scene scene = afloat(10);
  scene.forces.drag = true;
  scene.drag = {.linear = 500, .coefficient = 1.2};
  Scene faces = scene;
  faces.drag = {.faces = true, .form = 1.1, .skin = 0.01};
  for (Scene* tenth : {&scene, &faces}) {
    const Lattice lattice = block(floating + 0.05, {0.8, -0.6, 0}, {0.05, 0, 0.2});
    const Course slow = run(*tenth, lattice, 10, 0.1);
    Scene each = *tenth;
    each.water_pace = 1;
    const Course exact = run(each, lattice, 10, 0.1);
    const std::string which = tenth == &faces ? "drag on faces" : "drag";
    verify({.section = section_name,
            .quantity = "energy lost to " + which + " at pace 10 over 1, -1",
            .value = slow.drag.back() / exact.drag.back() - 1,
            .reference = 0.0,
            .tolerance = tenth == &faces ? 1e-4 : 1e-5,
            .note = tenth == &faces ? "the wetted faces are up to 2 ms old" : ""});
    EXPECT_LT(slow.distance(exact), 1e-3);  // of a way of 4 m
    EXPECT_LT(slow.worst_error(), 1e-5 * slow.drag.back());
  }
}

/// Vibrations of all frequencies, with k omega dt from 0 to 18, so at and about all multiples of 2
/// pi below: the water takes from each what it takes when computed in every step. Held forces would
/// feed those with k omega dt of about 4 by .3 of the drag's rate, and those of about 2 by buoyancy
/// (docs/decisions, "Pace of the water"); impulses every k-th step those at the multiples. Drag on
/// faces follows vibrations that are slow against the flow.
TEST(WaterPace, VibrationsAreNotFed) {
  enum class Drag { none, plan, faces };
  for (const auto& [drag, name, speed] : {std::tuple{Drag::none, "no drag", 0.4},
                                          {Drag::plan, "drag", 0.4},
                                          {Drag::faces, "drag on faces", 0.02}}) {
    Lattice lattice = sheet(6, 6, 1.5, true);
    Random random(4);
    for (std::size_t b = 0; b < lattice.bodies.position.size(); ++b) {
      lattice.bodies.velocity.push_back(random.vector(speed));
      lattice.bodies.angular_velocity.push_back(random.vector(speed));
    }
    Scene scene = afloat(10);
    scene.forces.beam = true;
    scene.forces.drag = drag != Drag::none;
    scene.drag.current = {0.5, 0, 0};
    scene.drag.faces = drag == Drag::faces;
    if (scene.drag.faces) {
      scene.drag.form = 1.1, scene.drag.skin = 0.1;
    } else {
      scene.drag.linear = 200, scene.drag.coefficient = 1;
    }
    const Course tenth = run(scene, lattice, 10, 1, 0);
    scene.water_pace = 1;
    const Course each = run(scene, lattice, 10, 1, 0);
    EXPECT_GT(each.strain[1], 0.5);
    const double tolerance = drag == Drag::faces ? 1e-2 : 1e-4;
    const std::string than = " of an undamped sheet after 10 s at pace 10 over 1, -1, ";
    verify({.section = section_name,
            .quantity = "energy of vibrations" + than + name,
            .value = tenth.strain.back() / each.strain.back() - 1,
            .reference = 0.0,
            .tolerance = tolerance});
    verify({.section = section_name,
            .quantity = "kinetic energy" + than + name,
            .value = tenth.kinetic.back() / each.kinetic.back() - 1,
            .reference = 0.0,
            .tolerance = tolerance});
    EXPECT_NEAR(tenth.worst_error() / each.worst_error(), 1, 0.05);
  }
}

/// Falls 2.5 m into the water, flat and on an edge: the wrench changes within a few steps.
TEST(WaterPace, ABlockFallsIntoTheWater) {
  for (const double tilt : {0.0, 0.6}) {
    Scene scene = afloat(10);
    scene.forces.drag = true;
    scene.drag = {.linear = 500, .coefficient = 1};
    const Lattice lattice = block(floating + 2.5, {}, {tilt, 0, 0});
    const Course tenth = run(scene, lattice, 6, 0.02);
    scene.water_pace = 1;
    const Course each = run(scene, lattice, 6, 0.02);
    const double moved = mass * gravity * 2.5;
    const std::string which = tilt == 0 ? "flat" : "on an edge";
    verify({.section = section_name,
            .quantity = "energy balance of a block that falls 2.5 m into the water " + which +
                        ", pace 10: largest error over its fall's energy",
            .value = tenth.worst_error() / moved,
            .reference = 0.0,
            .tolerance = 1e-4});
    EXPECT_LT(tenth.distance(each), 2e-3);
  }
}

TEST(WaterPace, WavesAndDragOnFaces) {
  Scene scene = afloat(10);
  scene.forces.drag = true;
  scene.drag = {.linear = 20, .current = {0.3, 0, 0}, .faces = true, .form = 1.1, .skin = 0.01};
  scene.waves = {.spectrum = WaveOptions::Spectrum::jonswap, .height = 1, .period = 17};
  const Lattice lattice = block(floating, {0, 0, 0.1}, {0.1, 0, 0.1});
  const Course tenth = run(scene, lattice, 20, 0.1);
  scene.water_pace = 1;
  const Course each = run(scene, lattice, 20, 0.1);
  verify({.section = section_name,
          .quantity = "way of a block in a sea for 20 s at pace 10: largest distance from pace 1",
          .value = tenth.distance(each),
          .reference = 0.0,
          .tolerance = 1e-3,
          .unit = "m"});
  double done = 0;
  for (std::size_t k = 0; k < tenth.drag.size(); ++k)
    done = std::max(done, std::abs(tenth.drag[k]) + std::abs(tenth.external[k]));
  EXPECT_GT(done, 1000);
  verify({.section = section_name,
          .quantity = "energy balance of that block: largest error over the work done",
          .value = tenth.worst_error() / done,
          .reference = 0.0,
          .tolerance = 1e-3});
}

}  // namespace
}  // namespace floe::test
