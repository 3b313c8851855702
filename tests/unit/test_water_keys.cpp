// What a scene says of drag on faces, added mass and waves.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "support/scene_options.h"

namespace floe {
namespace {

using WaterKeys = SceneOptions;

std::string adrift(const std::string& rest) {
  return "integrator: explicit\nforces: [beam, gravity, buoyancy, drag]\n"
         "sheet: {length: 40, thickness: 0.7}\n" +
         rest;
}

TEST_F(WaterKeys, Faces) {
  const Scene plain = scene_of(adrift("water: {drag: faces}\n"));
  EXPECT_TRUE(plain.drag.faces);
  EXPECT_EQ(plain.drag.form, 1.1);
  EXPECT_EQ(plain.drag.skin, 0.003);
  EXPECT_EQ(plain.drag.shelter, 0.7);  // the sheet's thickness
  EXPECT_EQ(plain.drag.linear, 0);
  const Scene all = scene_of(
      adrift("water: {drag: faces, drag_form: 2, drag_skin: 0, shelter: 0.2, drag_linear: 5}\n"));
  EXPECT_EQ(all.drag.form, 2);
  EXPECT_EQ(all.drag.skin, 0);
  EXPECT_EQ(all.drag.shelter, 0.2);
  EXPECT_EQ(all.drag.linear, 5);
  EXPECT_FALSE(scene_of(adrift("water: {drag_linear: 1}\n")).drag.faces);
  EXPECT_TRUE(
      contains(scene_error(adrift("water: {drag: faces, drag_form: 0, drag_skin: 0}\n")), "> 0"));
  EXPECT_TRUE(contains(scene_error("integrator: explicit\nforces: [drag]\nlattice_file: a.h5\n"
                                   "water: {drag: faces}\n"),
                       "water: shelter: is required with lattice_file"));
  // What shelters is found anew between steps of leapfrog.
  const std::string steady =
      "integrator: implicit\nforces: [beam, drag]\nsheet: {length: 40}\nwater: {drag: faces";
  EXPECT_EQ(scene_of(steady + "}\n").drag.shelter, 0);
  EXPECT_TRUE(contains(scene_error(steady + ", shelter: 1}\n"), "water: shelter: 1 must be 0"));
}

/// Bodies that may come loose have a pace of 10 by default, those of an intact sheet none.
TEST_F(WaterKeys, Pace) {
  const std::string drag = "water: {drag_linear: 1";
  EXPECT_EQ(scene_of(adrift(drag + "}\n")).water_pace, 1);
  EXPECT_EQ(scene_of(adrift(drag + ", pace: 4}\n")).water_pace, 4);
  const std::string breaks =
      "integrator: explicit\nforces: [beam, fracture, gravity, buoyancy]\n"
      "sheet: {length: 40}\nfracture: {tensile_strength: 1e5}\n";
  EXPECT_EQ(scene_of(breaks).water_pace, 10);
  EXPECT_EQ(scene_of(breaks + "water: {pace: 1}\n").water_pace, 1);
  EXPECT_TRUE(contains(scene_error(breaks + "water: {pace: 0}\n"), "water: pace"));
  EXPECT_TRUE(contains(scene_error(breaks + "water: {pace: 101}\n"), "<= 100"));
  // Only leapfrog steps at it; drag on the plan alone needs no submerged parts that change.
  EXPECT_TRUE(contains(scene_error("integrator: implicit\nforces: [beam, gravity, buoyancy]\n"
                                   "sheet: {length: 40}\nwater: {pace: 2}\n"),
                       "only leapfrog"));
  EXPECT_EQ(scene_of("integrator: explicit\nforces: [beam, fracture, drag]\nsheet: {length: 40}\n"
                     "fracture: {tensile_strength: 1e5}\nwater: {drag_linear: 1}\n")
                .water_pace,
            1);
  EXPECT_TRUE(contains(scene_error("integrator: explicit\nforces: [beam, drag]\n"
                                   "sheet: {length: 40}\nwater: {drag_linear: 1, pace: 2}\n"),
                       "without buoyancy"));
}

TEST_F(WaterKeys, AddedMass) {
  const std::string drag = "water: {drag_linear: 1, ";
  EXPECT_EQ(scene_of(adrift(drag + "added_mass: 0.5}\n")).added_mass, 0.5);
  const Scene plate = scene_of(adrift(drag + "added_mass: plate}\n"));
  EXPECT_TRUE(plate.added_mass_plate);
  EXPECT_EQ(plate.added_mass, 0);
  const Scene axes = scene_of(adrift(drag + "added_mass_axes: [1, 2, 3, 4, 5, 6]}\n"));
  EXPECT_EQ(axes.added_mass_axes.value()[4], 5);
  EXPECT_FALSE(axes.added_mass_plate);
  for (const auto* bad : {"-1", "1001", "nan", "plates"}) {
    EXPECT_TRUE(contains(scene_error(adrift(drag + "added_mass: " + bad + "}\n")),
                         "a number >= 0, <= 1e3, or plate"))
        << bad;
  }
  EXPECT_TRUE(contains(scene_error("integrator: implicit\nforces: [beam, gravity, buoyancy]\n"
                                   "sheet: {length: 40}\nwater: {added_mass: plate}\n"),
                       "leapfrog only"));
}

TEST_F(WaterKeys, Waves) {
  const std::string drag = "water: {drag_linear: 1}\n";
  EXPECT_FALSE(scene_of(adrift(drag)).waves.any());
  const WaveOptions one =
      scene_of(adrift(drag + "waves: {height: 0.4, period: 7, direction: 90, phase: -180, "
                             "depth: 12, ramp: 3}\n"))
          .waves;
  EXPECT_TRUE(one.any());
  EXPECT_EQ(one.height, 0.4);
  EXPECT_EQ(one.period, 7);
  EXPECT_NEAR(one.direction, M_PI / 2, 1e-15);
  EXPECT_NEAR(one.phase, -M_PI, 1e-15);
  EXPECT_EQ(one.depth, 12);
  EXPECT_EQ(one.ramp, 3);
  const WaveOptions sea =
      scene_of(adrift(drag + "waves: {spectrum: jonswap, height: 2, period: 9, gamma: 1, "
                             "components: 7, seed: 5}\n"))
          .waves;
  EXPECT_EQ(sea.spectrum, WaveOptions::Spectrum::jonswap);
  EXPECT_EQ(sea.gamma, 1);
  EXPECT_EQ(sea.components, 7);
  EXPECT_EQ(sea.seed, 5U);
  EXPECT_TRUE(std::isinf(sea.depth));
  EXPECT_TRUE(
      contains(scene_error(adrift(drag + "waves: {height: 1, period: 9, gamma: 2}\n")), "jonswap"));
  EXPECT_TRUE(contains(scene_error("integrator: implicit\nforces: [beam, gravity, buoyancy]\n"
                                   "sheet: {length: 40}\nwaves: {height: 1, period: 9}\n"),
                       "integrator: explicit"));
}

}  // namespace
}  // namespace floe
