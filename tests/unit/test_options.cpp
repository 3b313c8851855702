// Options: a scene's keys, and what is said of bad ones.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "floe/options/options.h"
#include "floe/scene.h"
#include "support/scene_options.h"

namespace floe {
namespace {

TEST_F(SceneOptions, DefaultsOfTheTableAreThoseOfTheStructs) {
  const Scene scene = scene_of("forces: [beam, gravity, buoyancy]\nsheet: {seed: 1}\n");
  const Scene plain;
  EXPECT_EQ(scene.sheet.length, plain.sheet.length);
  EXPECT_EQ(scene.sheet.width, plain.sheet.width);
  EXPECT_EQ(scene.sheet.element_size, plain.sheet.element_size);
  EXPECT_EQ(scene.sheet.seed, plain.sheet.seed);
  EXPECT_EQ(scene.sheet.relaxation, plain.sheet.relaxation);
  EXPECT_EQ(scene.sheet.iterations, plain.sheet.iterations);
  EXPECT_EQ(scene.sheet.tolerance, plain.sheet.tolerance);
  EXPECT_EQ(scene.thickness, plain.thickness);
  EXPECT_EQ(scene.ice.young, plain.ice.young);
  EXPECT_EQ(scene.ice.poisson, plain.ice.poisson);
  EXPECT_EQ(scene.ice.density, plain.ice.density);
  EXPECT_EQ(scene.shear_factor, plain.shear_factor);
  EXPECT_EQ(scene.torsion, plain.torsion);
  EXPECT_EQ(scene.beam.shear, plain.beam.shear);
  EXPECT_EQ(scene.beam.kinematics, plain.beam.kinematics);
  EXPECT_EQ(scene.gravity, plain.gravity);
  EXPECT_EQ(scene.water_density, plain.water_density);
  EXPECT_EQ(scene.time.end, plain.time.end);
  EXPECT_EQ(scene.time.dt, plain.time.dt);
  EXPECT_EQ(scene.output.history, plain.output.history);
  EXPECT_EQ(scene.output.fields, plain.output.fields);
  EXPECT_EQ(scene.check_only, plain.check_only);
  EXPECT_EQ(scene.name, "story");
  EXPECT_EQ(scene.output.dir, "out/story");
}

TEST_F(SceneOptions, EveryKeyArrivesInItsPlace) {
  const Scene s = scene_of(
      "integrator: quasistatic\nforces: beam gravity, buoyancy\ngravity: 1.62\nreport: [bending, "
      "tension]\n"
      "check: yes\n"
      "sheet: {length: 10, width: 8, thickness: 0.5, element_size: 1, seed: 9223372036854775807,\n"
      "  relaxation: quasi_newton, iterations: 3, tolerance: 1e-6}\n"
      "region: {names: [r, 2b], r: {box: [0, 1, 2, 3, 4, 5]}, 2b: {box: -1 1 -1 1 -1 1}}\n"
      "cut: {names: c, c: {from: [1, 2], to: [3, 4]}}\n"
      "ice: {young: 1e9, poisson: 0.25, density: 900}\n"
      "beam: {shear: none, shear_factor: 0.9, torsion: polar, kinematics: linear}\n"
      "water: {density: 1025}\n"
      "boundary:\n  names: [a, b]\n"
      "  a: {set: left, fix: [x, rz], velocity: [0.1, 0, 0], angular_velocity: [0, 0, 2], ramp: "
      "3}\n"
      "  b: {set: r, fix: z, displacement: [0, 0, -1]}\n"
      "load:\n  names: [p, q]\n"
      "  p: {point: [1, 2], force: [1, 2, 3], moment: [4, 5, 6], ramp: 7}\n"
      "  q: {set: right, force: [0, 0, 1]}\n"
      "time: {end: 4, dt: 0.5}\noutput: {dir: some where, history: 0.1, fields: 0.2}\n");
  EXPECT_TRUE(s.forces.beam && s.forces.gravity && s.forces.buoyancy && s.has_sheet &&
              s.check_only);
  EXPECT_TRUE(s.report.bending && s.report.tension);
  EXPECT_EQ(s.gravity, 1.62);
  EXPECT_EQ(s.sheet.width, 8);
  EXPECT_EQ(s.sheet.seed, 9223372036854775807U);
  EXPECT_EQ(s.sheet.relaxation, Relaxation::quasi_newton);
  EXPECT_EQ(s.sheet.iterations, 3);
  EXPECT_EQ(s.sheet.tolerance, 1e-6);
  ASSERT_EQ(s.regions.size(), 2U);
  EXPECT_EQ(s.regions[0].box, (std::array<double, 6>{0, 1, 2, 3, 4, 5}));
  EXPECT_EQ(s.regions[1].name, "2b");
  ASSERT_EQ(s.cuts.size(), 1U);
  EXPECT_EQ(s.cuts[0].to, (Point2{3, 4}));
  EXPECT_EQ(s.ice.poisson, 0.25);
  EXPECT_EQ(s.beam.shear, Shear::none);
  EXPECT_EQ(s.beam.kinematics, Kinematics::linear);
  EXPECT_EQ(s.torsion, Torsion::polar);
  EXPECT_EQ(s.shear_factor, 0.9);
  EXPECT_EQ(s.water_density, 1025);
  ASSERT_EQ(s.boundaries.size(), 2U);
  EXPECT_EQ(s.boundaries[0].fixed, (std::array<bool, 6>{true, false, false, false, false, true}));
  EXPECT_EQ(s.boundaries[0].velocity, (Point3{0.1, 0, 0}));
  EXPECT_FALSE(s.boundaries[0].displacement);
  EXPECT_EQ(s.boundaries[0].angular_velocity, (Point3{0, 0, 2}));
  EXPECT_EQ(s.boundaries[0].ramp.seconds, 3);
  EXPECT_EQ(s.boundaries[1].displacement, (Point3{0, 0, -1}));
  EXPECT_FALSE(s.boundaries[1].velocity);
  ASSERT_EQ(s.loads.size(), 2U);
  EXPECT_EQ(s.loads[0].point, (Point2{1, 2}));
  EXPECT_EQ(s.loads[0].moment, (Point3{4, 5, 6}));
  EXPECT_EQ(s.loads[1].set, "right");
  EXPECT_FALSE(s.loads[1].point);
  EXPECT_EQ(s.time.end, 4);
  EXPECT_EQ(s.time.dt, 0.5);
  EXPECT_EQ(s.output.dir, "some where");
  EXPECT_EQ(s.output.history, 0.1);
  EXPECT_EQ(s.output.fields, 0.2);
}

TEST_F(SceneOptions, OptionsAsUsedRepeatTheRun) {
  const Scene first = scene_of(
      std::string(minimal) +
          "boundary: {names: [a], a: {set: left, fix: [x], displacement: [1, 0, 0]}}\n"
          "region: {names: [r], r: {box: [0, 1, 0, 1, 0, 1]}}\noutput: {dir: 'some \"where\"'}\n"
          "snes_rtol: 1e-9\nksp_view:\nlog_view: ':log.txt'\n",
      words("sheet_seed", "3"));
  EXPECT_TRUE(contains(first.options_yaml, "  seed: 3\n"));
  EXPECT_TRUE(contains(first.options_yaml, "snes_rtol: 1e-9\n"));
  EXPECT_TRUE(contains(first.options_yaml, "ksp_view:\n"));
  EXPECT_TRUE(contains(first.options_yaml, "log_view: \":log.txt\"\n"));
  const Scene again = read_scene("elsewhere/options.yaml", given(first.options_yaml));
  EXPECT_EQ(again.options_yaml, first.options_yaml);
  EXPECT_EQ(again.output.dir, "some \"where\"");
}

TEST_F(SceneOptions, AnUnknownOptionNamesTheNearest) {
  EXPECT_EQ(error_with("shet: {length: 3}\n"),
            "shet_length: unknown option; the nearest known one is 'sheet: length' (floe -help "
            "lists them) (story.yaml, line 3)");
  EXPECT_TRUE(contains(error_with("kps_type: cg\n"), "ksp_type"));
}

TEST_F(SceneOptions, ErrorsNameKeyValueAndWhatIsAllowed) {
  EXPECT_EQ(error_with("sheet_thickness: -3\n"),
            "sheet: thickness: -3 must be a number >= 1e-9, <= 1e9 [m] (story.yaml, line 3)");
  EXPECT_EQ(error_with("ice:\n  young: nan\n"),
            "ice: young: nan must be a number >= 1, <= 1e18 [Pa] (story.yaml, line 4)");
  for (const auto* nothing : {"", "~", "null"})
    EXPECT_EQ(
        error_with("ice: {young: " + std::string(nothing) + "}\n"),
        "ice: young: no value given, must be a number >= 1, <= 1e18 [Pa] (story.yaml, line 3)");
  EXPECT_EQ(error_with("beam: {shear: strong}\n"),
            "beam: shear: strong must be one of one_point | exact | none (story.yaml, line 3)");
  EXPECT_EQ(error_with("load: {names: [p], p: {set: left, force: [1, 2, 3, 4]}}\n"),
            "load: p: force: 1,2,3,4 must be 3 numbers >= -1e18, <= 1e18 [N] (story.yaml, line 3)");
  EXPECT_EQ(
      error_with("boundary: {names: [a], a: {set: left}}\n"),
      "boundary: a: fix: is missing; it must be a list of x | y | z | rx | ry | rz, none twice");
}

TEST_F(SceneOptions, WhatWouldHaveNoEffectIsAnError) {
  const std::string file = "forces: [beam]\nlattice_file: a.h5\n";
  EXPECT_EQ(scene_error(file), "");
  for (const auto* line : {"ice: {young: 1}", "beam: {shear_factor: 1}", "beam: {torsion: polar}",
                           "sheet: {length: 3}", "gravity: 9.81", "water: {density: 1000}"})
    EXPECT_NE(scene_error(file + line), "") << line;
  EXPECT_NE(scene_error("forces: [beam]\n"), "");
  EXPECT_TRUE(contains(scene_error("forces: [gravity]\nsheet: {length: 3}\nbeam: {shear: none}\n"),
                       "beam: shear: would have no effect"));
}

TEST_F(SceneOptions, DragNeedsMotionAndALaw) {
  const std::string drag =
      "integrator: explicit\nforces: [gravity, buoyancy, drag]\nsheet: {length: 40}\n";
  const Scene s = scene_of(drag +
                           "water: {density: 1025, drag_linear: 2, drag_coefficient: 3, "
                           "current: [4, 5, 6], added_mass: 0.7}\n");
  EXPECT_TRUE(s.forces.drag);
  EXPECT_EQ(s.drag.linear, 2);
  EXPECT_EQ(s.drag.coefficient, 3);
  EXPECT_EQ(s.drag.density, 1025);
  EXPECT_EQ(s.drag.current, (Point3{4, 5, 6}));
  EXPECT_EQ(s.added_mass, 0.7);
  EXPECT_TRUE(contains(scene_error(drag), "water: drag_linear"));
  EXPECT_TRUE(contains(scene_error("forces: [gravity, buoyancy, drag]\nsheet: {length: 40}\n"
                                   "water: {drag_linear: 2}\n"),
                       "quasistatic"));
  EXPECT_TRUE(contains(error_with("water: {added_mass: 1}\n"), "quasistatic"));
  const std::string afloat =
      "integrator: explicit\nforces: [beam, gravity, buoyancy]\nsheet: {length: 40}\n";
  EXPECT_EQ(scene_error(afloat + "water: {added_mass: 1}\n"), "");
  for (const auto* key : {"drag_linear: 1", "drag_coefficient: 1", "current: [1, 0, 0]"})
    EXPECT_TRUE(contains(scene_error(afloat + "water: {" + key + "}\n"), "'drag' is not in"))
        << key;
  const std::string alone = "integrator: explicit\nforces: [drag]\nsheet: {length: 40}\n";
  EXPECT_EQ(scene_error(alone + "water: {drag_linear: 1}\n"), "");
  EXPECT_EQ(scene_error(alone + "water: {drag_coefficient: 1, density: 1000}\n"), "");
  EXPECT_NE(scene_error(alone + "water: {drag_linear: 1, density: 1000}\n"), "");
}

TEST_F(SceneOptions, SectionsOfNamesMustMatchTheirList) {
  EXPECT_TRUE(contains(error_with("region: {names: [r]}\n"), "no such section"));
  EXPECT_TRUE(contains(error_with("region: {names: [r], r: }\n"), "no such section"));
  EXPECT_TRUE(contains(error_with("region: {r: {box: [0, 1, 0, 1, 0, 1]}}\n"), "not listed"));
  EXPECT_EQ(error_with("region: {names: [Aa1], Aa1: {box: 0 1 0 1 0 1}}\n"), "");
  for (const auto* names : {"[a, a]", "[a, A]", "[a_b]", "[names]", "['']", "[ä]"})
    EXPECT_NE(error_with("region: {names: " + std::string(names) + ", a: {box: 0 1 0 1 0 1}}\n"),
              "")
        << names;
  EXPECT_EQ(error_with("region:\nload: {}\nboundary: {names: []}\n"), "")
      << "empty sections are absent";
}

TEST_F(SceneOptions, CrossChecks) {
  EXPECT_EQ(error_with("sheet_element_size: 41\n"),
            "sheet: element_size: 41 must be <= sheet: length 40 [m]");
  EXPECT_NE(error_with("sheet_element_size: 1e-5\n"), "");
  EXPECT_NE(error_with("ice: {poisson: 0.5}\n"), "");
  EXPECT_NE(error_with("ice: {density: 1010}\n"), "") << "sinks";
  EXPECT_NE(error_with("time: {dt: 2}\n"), "");
  EXPECT_NE(error_with("cut: {names: c, c: {from: [1, 1], to: [1, 1]}}\n"), "");
  const std::string one_cut = "cut: {names: c, c: {from: [1, 1], to: [1, 2]}}\n";
  EXPECT_TRUE(scene_of(minimal + one_cut).fit_cuts);
  EXPECT_FALSE(scene_of(minimal + one_cut + "sheet_fit_cuts: false\n").fit_cuts);
  EXPECT_TRUE(contains(error_with("sheet_fit_cuts: false\n"), "the scene has no 'cut'"));
  EXPECT_NE(error_with("region: {names: left, left: {box: 0 1 0 1 0 1}}\n"), "");
  EXPECT_NE(scene_error("forces: [beam, buoyancy]\nsheet: {length: 40}\n"), "");
  const auto boundary = [](const std::string& rest) {
    return error_with("boundary: {names: [a], a: {set: left, fix: x y rz, " + rest + "}}\n");
  };
  EXPECT_EQ(boundary("velocity: [1, 2, 0]"), "");
  EXPECT_TRUE(contains(boundary("velocity: [1, 2, 3]"), "'z' is not in"));
  EXPECT_TRUE(contains(boundary("angular_velocity: [1, 0, 0]"), "'rx' is not in"));
  EXPECT_NE(boundary("velocity: [1, 0, 0], displacement: [1, 0, 0]"), "");
  const auto load = [](const std::string& rest) {
    return error_with("load: {names: [p], p: {force: [1, 0, 0], " + rest + "}}\n");
  };
  EXPECT_EQ(load("point: [0, 0]"), "");
  EXPECT_NE(load("point: [0, 0], set: left"), "");
  EXPECT_NE(load("ramp: 1"), "");
}

TEST_F(SceneOptions, OutputFolderMustBePossible) {
  const std::string file = testing::TempDir() + "floe_regular_file";
  std::ofstream(file) << "x";
  EXPECT_TRUE(contains(error_with("output: {dir: " + file + "/below}\n"), "is not one"));
  EXPECT_NE(error_with("output: {dir: " + file + "}\n"), "");
  EXPECT_EQ(error_with("output: {dir: " + testing::TempDir() + "floe/new/folder}\n"), "");
  EXPECT_FALSE(std::filesystem::exists(testing::TempDir() + "floe/new"));
  std::filesystem::remove(file);
}

TEST_F(SceneOptions, TenThousandSectionsAreRead) {
  std::string names, sections;
  for (int k = 0; k < 10'000; ++k) {
    const std::string name = "c" + std::to_string(k), y = std::to_string(0.001 * k);
    names += (k ? ", " : "") + name;
    sections += "  " + name + ": {from: [0, " + y + "], to: [1, " + y + "]}\n";
  }
  const std::string cuts = "cut:\n  names: [" + names + "]\n" + sections;
  const Scene scene = scene_of(minimal + cuts, words("cut_c9999_to", "2 3"));
  ASSERT_EQ(scene.cuts.size(), 10'000U);
  EXPECT_EQ(scene.cuts[9998].to, (Point2{1, 9.998}));
  EXPECT_EQ(scene.cuts[9999].to, (Point2{2, 3}));
  // All of them idle: the file is read a second time.
  EXPECT_TRUE(contains(remark_of(minimal + cuts, words("cut_names", "c1")), "and 9993 more"));
}

}  // namespace
}  // namespace floe
