// Options: the table's reader, the scene's keys, the command line and the text of a scene.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>

#include "base/option_names.h"
#include "base/option_values.h"
#include "floe/base/command_line.h"
#include "floe/base/environment.h"
#include "floe/base/options.h"
#include "floe/base/scene_text.h"
#include "floe/base/spelling.h"
#include "floe/scene.h"
#include "scene/keys.h"

namespace floe {
namespace {

/// The message of the InputError that `call` throws, "" if it throws none.
template <class Call>
std::string error_of(Call&& call) {
  try {
    call();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

constexpr auto minimal = "forces: [beam, gravity, buoyancy]\nsheet: {length: 40}\n";

class SceneOptions : public testing::Test {
 protected:
  static UserOptions given(const std::string& yaml, const GivenOptions& command_line = {}) {
    return {{}, parse_scene("story.yaml", yaml), command_line};
  }
  static Scene scene_of(const std::string& yaml, const GivenOptions& command_line = {}) {
    return read_scene("folder/story.yaml", given(yaml, command_line));
  }
  static std::string scene_error(const std::string& yaml, const GivenOptions& command_line = {}) {
    return error_of([&] { scene_of(yaml, command_line); });
  }
  /// Of the minimal scene with one more line.
  static std::string error_with(const std::string& line) { return scene_error(minimal + line); }
  /// A command line of one option.
  static GivenOptions words(const std::string& name, const std::string& value) {
    return {{name, {value, Source::command_line, {}, false}}};
  }
  /// The only remark of a scene under a command line, "" if there is none.
  static std::string remark_of(const std::string& yaml, const GivenOptions& command_line) {
    const Scene scene = scene_of(yaml, command_line);
    EXPECT_LE(scene.remarks.size(), 1U);
    return scene.remarks.empty() ? "" : scene.remarks.front();
  }
};

/// What is in PETSc's table for one test.
class PetscTable {
 public:
  explicit PetscTable(const std::string& options) {
    check(PetscOptionsClear(nullptr));
    check(PetscOptionsInsertString(nullptr, options.c_str()));
  }
  ~PetscTable() { (void)PetscOptionsClear(nullptr); }
  PetscTable(const PetscTable&) = delete;
  PetscTable& operator=(const PetscTable&) = delete;
};

TEST(OptionValues, AreConvertedStrictly) {
  EXPECT_EQ(to_number(" 4e9 "), 4e9);
  EXPECT_EQ(to_number("+.5"), 0.5);
  EXPECT_EQ(to_number("-1e4"), -1e4);
  for (const auto* bad :
       {"", " ", "nan", "inf", "-inf", "1e999", "3m", "1 2", "0x10", "+-1", "1,2", "--1"})
    EXPECT_FALSE(to_number(bad)) << bad;
  EXPECT_EQ(to_integer("9223372036854775807"), 9223372036854775807);
  for (const auto* bad : {"", "1.5", "1e3", "9223372036854775808", "x"})
    EXPECT_FALSE(to_integer(bad)) << bad;
  for (const auto* yes : {"", "true", "Yes", "1", "True", "TRUE", "on", "ON"})
    EXPECT_EQ(to_flag(yes), true) << yes;
  for (const auto* no : {"false", "NO", "0", "False", "off"}) EXPECT_EQ(to_flag(no), false) << no;
  EXPECT_FALSE(to_flag("maybe"));
}

TEST(OptionValues, DurationsAreReadWithUnitsAsOnAClockOrInSeconds) {
  for (const auto& [text, seconds] : std::map<std::string, double>{{"90", 90},
                                                                   {"1e3", 1000},
                                                                   {"90s", 90},
                                                                   {"2h", 7200},
                                                                   {"3h50m", 13800},
                                                                   {"3h 50m", 13800},
                                                                   {"1.5h", 5400},
                                                                   {"1d12h0m1s", 129601},
                                                                   {"01:30:00", 5400},
                                                                   {"100:00:01", 360001},
                                                                   {"1-02:03:04", 93784}})
    EXPECT_EQ(to_duration(text), seconds) << text;
  for (const char* bad : {"", "h", "3x", "2m3h", "3h3h", "3h5", "5 minutes", "1:2", "1:2:3:4", "::",
                          "1:60:00", "1:00:60", "-1:00:00", "1--1:00:00", "0h", "nan", "inf", "h3"})
    EXPECT_FALSE(to_duration(bad)) << bad;
}

TEST(OptionValues, ListsAreSeparatedByCommasOrBlanks) {
  using List = std::vector<std::string>;
  EXPECT_EQ(to_list("a,b"), (List{"a", "b"}));
  EXPECT_EQ(to_list(" a b ,  c "), (List{"a", "b", "c"}));
  EXPECT_EQ(to_list(""), List{});
  for (const auto* bad : {"a,,b", ",a", "a,", ","}) EXPECT_FALSE(to_list(bad)) << bad;
}

TEST(OptionValues, RangesAreOpenOrClosedAsWritten) {
  EXPECT_FALSE(in_range(0, "> 0"));
  EXPECT_TRUE(in_range(0, ">= 0"));
  EXPECT_TRUE(in_range(0.49, "> -1, < 0.5"));
  EXPECT_FALSE(in_range(0.5, "> -1, < 0.5"));
  EXPECT_FALSE(in_range(-1, "> -1, < 0.5"));
  EXPECT_TRUE(in_range(1e7, ">= 0, <= 1e7"));
  EXPECT_FALSE(in_range(1.1e7, ">= 0, <= 1e7"));
  EXPECT_TRUE(in_range(-7, ""));
  for (const auto* bad : {"about 3", ">", "> x", "= 3", "> 0,< 1"})
    EXPECT_THROW(in_range(0, bad), std::logic_error) << bad;
}

TEST(OptionNames, NearestIsASpellingOrTheRightWordInTheWrongSection) {
  const auto nearest = [](const char* name) { return nearest_option(name, scene_keys()); };
  EXPECT_EQ(nearest("shet_length"), "sheet: length");
  EXPECT_EQ(nearest("sheet_lenght"), "sheet: length");
  EXPECT_EQ(nearest("length"), "sheet: length");
  EXPECT_EQ(nearest("ice_thickness"), "sheet: thickness");
  EXPECT_EQ(nearest("boundary_push_fx"), "boundary: NAME: fix");
  EXPECT_EQ(nearest("shet"), "sheet:");
  EXPECT_EQ(nearest("kps_type"), "ksp_type");
  EXPECT_EQ(nearest("sness_divergence_tolerance"), "snes_divergence_tolerance");
  EXPECT_EQ(nearest("colour"), "");
}

TEST(OptionNames, PetscFamiliesAreLeftToPetsc) {
  for (const auto* name :
       {"snes_rtol", "ksp_type", "pc_factor_mat_solver_type", "mat_mumps_icntl_14", "log_view",
        "options_left", "fieldsplit_0_ksp_type", "info", "malloc_debug"})
    EXPECT_TRUE(is_petsc_option(name)) << name;
  for (const auto* name : {"foo", "sheet_length", "history", "information", "snes"})
    EXPECT_FALSE(is_petsc_option(name)) << name;
}

TEST(SceneKeys, TableIsConsistent) {
  for (const OptionSpec& line : scene_keys()) {
    EXPECT_FALSE(is_petsc_option(option_name(line.key))) << line.key;
    EXPECT_FALSE(line.doc.empty()) << line.key;
    EXPECT_EQ(line.kind == Kind::numbers, line.count > 1) << line.key;
    if (line.kind != Kind::number && line.kind != Kind::integer && line.kind != Kind::numbers)
      continue;
    const Bounds bounds = bounds_of(line.allowed);
    EXPECT_TRUE(std::isfinite(bounds.least) && std::isfinite(bounds.most)) << line.key;
    EXPECT_LT(bounds.least, bounds.most) << line.key;
    const auto fallback = to_number(line.fallback);
    EXPECT_TRUE(!fallback || in_range(*fallback, line.allowed)) << line.key;
  }
}

TEST(SceneKeys, HelpOfATopicIsASectionOrAKey) {
  const auto lines = [](const char* topic) {
    const std::string text = options_topic(topic);
    return std::count(text.begin(), text.end(), '\n') / 2;
  };
  EXPECT_EQ(lines("sheet_length"), 1);
  EXPECT_EQ(lines("sheet: length"), 1);
  EXPECT_EQ(lines("-gravity"), 1);
  EXPECT_EQ(lines("boundary_left_fix"), 1);
  EXPECT_EQ(lines("sheet"), lines("sheet:"));
  EXPECT_EQ(lines("cut"), 3);
  EXPECT_EQ(lines("cut_mine"), 2);
  EXPECT_EQ(options_topic("shet"), "");
  EXPECT_EQ(options_topic(""), "");
  EXPECT_TRUE(contains(options_topic("sheet_thickness"), "a number >= 1e-9, <= 1e9 [m]"));
}

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

TEST_F(SceneOptions, UnusedPetscOptionsAreRejectedUnlessTheyMayBeLate) {
  const auto error = [](const std::set<std::string>& exempt = {}) {
    return error_of([&] { reject_unused_options(exempt); });
  };
  {
    const PetscTable table("-ksp_view -viewer_x 1");
    EXPECT_EQ(error(), "");
  }
  const PetscTable table("-ksp_tpye cg");
  EXPECT_TRUE(contains(error(), "is it 'ksp_type'?"));
  EXPECT_EQ(error({"ksp_tpye"}), "");
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

TEST_F(SceneOptions, WhatTheCommandLineMakesIdleIsARemark) {
  const std::string moving = "integrator: explicit\n" + std::string(minimal);
  const std::string damped = moving + "beam: {damping_ratio: 0.1, damping_modes: axial}\n";
  EXPECT_EQ(remark_of(damped, {}), "");
  EXPECT_EQ(remark_of(damped, words("beam_damping_ratio", "0")),
            "left without effect by the command line: beam: damping_modes (would have no effect: "
            "'beam: damping_ratio' is 0)");
  // What the file itself makes idle, and what the command line gives in vain, stays an error.
  const std::string undamped = moving + "beam: {damping_modes: axial}\n";
  EXPECT_TRUE(contains(scene_error(undamped), "beam: damping_modes: would have no effect"));
  EXPECT_TRUE(
      contains(scene_error(undamped, words("sheet_seed", "2")), "beam: damping_modes: would"));
  EXPECT_TRUE(contains(scene_error(moving, words("beam_damping_modes", "axial")), "damping_modes"));

  EXPECT_TRUE(
      contains(remark_of(damped + "time: {safety: 0.5}\nlimit: {velocity: 3}\n"
                                  "initial: {names: [i], i: {set: all, velocity: [1, 0, 0]}}\n",
                         words("integrator", "quasistatic")),
               "initial: names, limit: velocity, time: safety, beam: damping_ratio, beam: "
               "damping_modes"));
  EXPECT_TRUE(contains(remark_of(std::string(minimal) + "gravity: 9\nwater: {density: 1025}\n",
                                 words("forces", "beam")),
                       "gravity, water: density"));
  EXPECT_TRUE(contains(remark_of(minimal, words("lattice_file", "a.h5")), "sheet: length"));
  EXPECT_TRUE(
      contains(scene_error("forces: [beam]\nlattice_file: a.h5\n", words("sheet_length", "3")),
               "this one has both"));
}

TEST_F(SceneOptions, OfTwoKeysThatExcludeEachOtherTheCommandLinesCounts) {
  const std::string pushed =
      std::string(minimal) +
      "boundary: {names: [a], a: {set: left, fix: x y, velocity: [1, 2, 0]}}\n"
      "load: {names: [p], p: {set: left, force: [1, 0, 0]}}\n";
  GivenOptions other = words("boundary_a_displacement", "3 0 0");
  other["load_p_point"] = {"1 1", Source::command_line, {}, false};
  const Scene scene = scene_of(pushed, other);
  EXPECT_EQ(scene.boundaries[0].displacement, (Point3{3, 0, 0}));
  EXPECT_FALSE(scene.boundaries[0].velocity);
  EXPECT_EQ(scene.loads[0].point, (Point2{1, 1}));
  EXPECT_EQ(scene.loads[0].set, "");
  ASSERT_EQ(scene.remarks.size(), 1U);
  EXPECT_TRUE(contains(scene.remarks[0], "boundary: a: velocity, load: p: set"));
  // Components that the command line frees
  const Scene freed = scene_of(pushed, words("boundary_a_fix", "x"));
  EXPECT_EQ(freed.boundaries[0].velocity, (Point3{1, 0, 0}));
  EXPECT_TRUE(contains(freed.remarks.at(0), "2 has no effect: 'y' is not in"));
  // A section that is not named any more
  EXPECT_TRUE(contains(remark_of(pushed, words("load_names", "")), "load: p"));
  EXPECT_TRUE(contains(remark_of("integrator: explicit\nforces: [gravity, buoyancy, drag]\n"
                                 "sheet: {length: 40}\nwater: {drag_linear: 1}\n",
                                 words("integrator", "quasistatic")),
                       "forces: drag"));
}

TEST_F(SceneOptions, OptionsOfTheEnvironmentAreThoseOfPetscOnly) {
  UserOptions user = given(minimal);
  user.environment = parse_petsc_options(
      "-snes_rtol 1e-3 -ksp_monitor -sheet_length 3 -ts_type bdf -foo 'a b' stray -options_file x",
      "PETSC_OPTIONS");
  user.scene["ksp_monitor"] = {":file", Source::scene, {}, false};
  const Scene scene = read_scene("story.yaml", user);
  EXPECT_EQ(scene.sheet.length, 40);
  EXPECT_TRUE(contains(scene.options_yaml, "snes_rtol: 1e-3\n"));
  EXPECT_TRUE(contains(scene.options_yaml, "ksp_monitor: \":file\"\n")) << "the scene's wins";
  EXPECT_FALSE(contains(scene.options_yaml, "foo"));
  EXPECT_EQ(scene.unused_options, (std::set<std::string>{"snes_rtol"}));
  ASSERT_EQ(scene.remarks.size(), 1U);
  EXPECT_EQ(scene.remarks[0],
            "options of the environment: -snes_rtol 1e-3 (PETSC_OPTIONS); not taken: -foo "
            "(PETSC_OPTIONS), -options_file (PETSC_OPTIONS), -ts_type (PETSC_OPTIONS)");
}

TEST_F(SceneOptions, SolverOptionsThatNothingCouldAskForAreLeftOut) {
  const std::string moving = "integrator: explicit\n" + std::string(minimal);
  UserOptions user = given(moving);
  user.environment = parse_petscrc("# mine\n-ksp_type cg # why\n\n-log_view\n", ".petscrc");
  const Scene scene = read_scene("story.yaml", user);
  EXPECT_EQ(scene.remarks.at(0),
            "options of the environment: -log_view (.petscrc, line 4); not taken: -ksp_type "
            "(.petscrc, line 2)");
  const Scene still =
      scene_of(std::string(minimal) + "snes_rtol: 1e-9\n", words("integrator", "explicit"));
  EXPECT_TRUE(contains(still.remarks.at(0), "snes_rtol (nothing in this run would ask for it)"));
  EXPECT_FALSE(contains(still.options_yaml, "snes_rtol"));
}

TEST(Environment, TextsAreSplitAsPetscDoes) {
  const GivenOptions options = parse_petsc_options(" -a  -b -1  -c \"x y\"  -d 'z' -e", "here");
  ASSERT_EQ(options.size(), 5U);
  EXPECT_EQ(options.at("a").value, "");
  EXPECT_EQ(options.at("b").value, "-1");
  EXPECT_EQ(options.at("c").value, "x y");
  EXPECT_EQ(options.at("d").value, "z");
  const GivenOptions file = parse_petscrc("-a 1\r\n\t-b\nalias -c -d\njunk\n#-e\n-a 2\n", "rc");
  ASSERT_EQ(file.size(), 2U);
  EXPECT_EQ(file.at("a").value, "2");
  EXPECT_EQ(file.at("a").place, "rc, line 6");
  EXPECT_EQ(file.at("a").source, Source::environment);
}

std::string command_line_error(std::vector<const char*> words) {
  words.insert(words.begin(), "floe");
  return error_of([&] { read_command_line(static_cast<int>(words.size()), words.data()); });
}

TEST(CommandLine, WordsMustBelongToAnOption) {
  EXPECT_EQ(command_line_error({"a.yaml", "-gravity", "-9.81", "-check", "-output_dir", "x"}), "");
  EXPECT_EQ(command_line_error({"a.yaml", "-sheet_length", "-inf"}), "")
      << "refused later, as a value";
  for (const auto* word : {"stray", "-", "-1", "", "--key", "-key=3", "-options_file"})
    EXPECT_NE(command_line_error({"a.yaml", word}), "") << word;
  EXPECT_NE(command_line_error({"a.yaml", "-check", "no", "stray"}), "");
  EXPECT_NE(command_line_error({"a.yaml", "-skip_petscrc", "perhaps"}), "");
  EXPECT_TRUE(contains(command_line_error({}), "usage"));
  EXPECT_TRUE(contains(command_line_error({"-check", "a.yaml"}), "usage"));
}

TEST(CommandLine, TheLastValueCounts) {
  const std::array words{"floe",     "a.yaml", "-gravity",      "1",     "-KSP_Type", "cg",
                         "-gravity", "-2",     "-skip_petscrc", "-check"};
  const CommandLine line = read_command_line(static_cast<int>(words.size()), words.data());
  EXPECT_EQ(line.scene, "a.yaml");
  EXPECT_FALSE(line.petscrc);
  ASSERT_EQ(line.options.size(), 3U);
  EXPECT_EQ(line.options.at("gravity").value, "-2");
  EXPECT_EQ(line.options.at("ksp_type").value, "cg") << "PETSc knows no upper case";
  EXPECT_EQ(line.options.at("check").value, "");
}

TEST(CommandLine, HelpNeedsNoScene) {
  const auto help = [](std::vector<const char*> words) {
    return wants_help(static_cast<int>(words.size()), words.data());
  };
  EXPECT_EQ(help({"floe", "a.yaml", "-check"}).kind, Help::none);
  EXPECT_EQ(help({"floe", "-help"}).kind, Help::text);
  EXPECT_EQ(help({"floe", "-help"}).topic, "");
  EXPECT_EQ(help({"floe", "-help", "sheet"}).topic, "sheet");
  EXPECT_EQ(help({"floe", "a.yaml", "-check", "-help"}).kind, Help::text);
  EXPECT_EQ(help({"floe", "-help_markdown"}).kind, Help::markdown);
}

TEST(Spelling, NearestWordIsNotFarAway) {
  constexpr std::array<std::string_view, 3> known{"plot_load", "plot_sheet", "render"};
  EXPECT_EQ(nearest_word("plotload", known), "plot_load");
  EXPECT_EQ(nearest_word("redner", known), "render");
  EXPECT_EQ(nearest_word("campaign", known), "");
}

std::string text_error(const std::string& text) {
  const std::string path = testing::TempDir() + "floe_scene_text.yaml";
  std::ofstream(path, std::ios::binary) << text;
  std::string error = error_of([&] { read_scene_text(path); });
  std::filesystem::remove(path);
  return error;
}

TEST(SceneText, SyntaxErrorsNameTheLine) {
  EXPECT_EQ(text_error("a: 1\nb: [1, 2, {c: 3}]\n").find("line 2") == std::string::npos, false);
  EXPECT_TRUE(contains(text_error("a: 1\nb: c: d\n"), "line 2"));
  EXPECT_TRUE(contains(text_error("a: 1\n\n\tb: 2\n"), "line 3"));
  EXPECT_NE(text_error("a: \x01\n"), "");
  EXPECT_NE(text_error(std::string("a: 1\n\0b: 2\n", 11)), "");
}

TEST(SceneText, KeysAreGivenOnce) {
  EXPECT_TRUE(
      contains(text_error("a: 1\nb: 2\na: 3\n"), "line 3: a is given twice, first in line 1"));
  EXPECT_TRUE(contains(text_error("sheet: {length: 1}\nsheet_length: 1\n"), "given twice"));
  EXPECT_TRUE(contains(text_error("sheet:\n  length: 1\nsheet:\n  width: 1\n"), "given twice"));
  EXPECT_EQ(text_error("a: 1\nA: 1\n"), "");
  EXPECT_TRUE(contains(text_error("ksp_type: cg\nKSP_Type: cg\n"), "given twice"))
      << "PETSc does not tell them apart";
  EXPECT_EQ(text_error("a: {b: 1}\nb: {a: 1}\n"), "");
}

TEST(SceneText, OnlyMapsOfPlainValues) {
  EXPECT_EQ(text_error("---\na: 1\nb: [1, x, -3e4]\nc: {d: {e: ~}}\nf:\n"), "");
  EXPECT_EQ(text_error(""), "");
  for (const auto* bad :
       {"- 1\n", "word\n", "a: 1\n---\nb: 1\n", "a: [[1]]\n", "a: [1, '']\n", "a b: 1\n",
        "'a-b': 1\n", "? [a]\n: 1\n", "<<: {a: 1}\n", "$$x: 1\n", "1a: 1\n", "help: true\n",
        "options_file: x\n", "a: *y\n", "a: &x {b: *x}\n", "a: &x {b: 1}\nc: *x\n", "a: !mine 1\n",
        "a: !!binary eA==\n"})
    EXPECT_TRUE(contains(text_error(bad), ": line ")) << bad << text_error(bad);
  EXPECT_NE(text_error("ksp_" + std::string(60, 'k') + ": 1\n"), "") << "PETSc would cut it";
  EXPECT_NE(text_error(std::string(130, 'k') + ": 1\n"), "");
}

TEST(SceneText, BecomesOptions) {
  const GivenOptions options =
      parse_scene("s.yaml", "a: {b: {c_d: 1}}\ne: [x, -3, 'y z']\nf: ~\ng: '~'\nh: !!str 5\ni:\n");
  ASSERT_EQ(options.size(), 6U);
  EXPECT_EQ(options.at("a_b_c_d").value, "1");
  EXPECT_EQ(options.at("a_b_c_d").place, "s.yaml, line 1");
  EXPECT_EQ(options.at("e").value, "x,-3,y z");
  EXPECT_TRUE(options.at("e").is_list);
  EXPECT_EQ(options.at("f").value, "");
  EXPECT_EQ(options.at("g").value, "~");
  EXPECT_EQ(options.at("h").value, "5");
  EXPECT_EQ(options.at("i").value, "");
}

TEST(SceneText, AliasesStandForValuesAndLists) {
  const GivenOptions options = parse_scene("", "a: &x 3\nb: &y [1, *x]\nc: *y\nd: {e: *x}\n");
  EXPECT_EQ(options.at("b").value, "1,3");
  EXPECT_EQ(options.at("c").value, "1,3");
  EXPECT_TRUE(options.at("c").is_list);
  EXPECT_EQ(options.at("d_e").value, "3");
}

TEST(SceneText, FilesOfOtherSystems) {
  EXPECT_EQ(parse_scene("",
                        "\xEF\xBB\xBF"
                        "a: 1\r\nb: [2, 3]\r\n")
                .at("b")
                .value,
            "2,3");
  EXPECT_EQ(text_error(std::string("\xFF\xFE"
                                   "a\0:\0",
                                   6))
                .substr(text_error("- 1\n").find(": line")),
            ": line 1: is a text in UTF-16; save it in UTF-8");
  EXPECT_TRUE(contains(text_error("a: 1\nb: \xE4\n"), "line 2: not a text in UTF-8"));
  EXPECT_TRUE(contains(text_error("a: 1\n\nb: \x01\n"), "line 3"));
  EXPECT_TRUE(contains(text_error("a:\n\tb: 2\n"), "line 2: a tab; YAML wants blanks"));
}

/// What once took half a minute, or all memory: takes no time now, whatever the machine.
TEST(SceneText, HostileTexts) {
  constexpr std::size_t many = 1'000'000;
  const auto repeated = [](const std::string& part) {
    std::string text;
    for (std::size_t k = 0; k < many; ++k) text += part;
    return text;
  };
  for (const auto* part :
       {"[", "{", "{a: ", "- ", "? ", "a: [", "&a ", "!!str ", "\"", "|\n", "a:\n "})
    EXPECT_TRUE(contains(text_error("a: " + repeated(part)), ": line ")) << part;
  EXPECT_TRUE(
      contains(text_error("a: {b: {c: {d: {e: {f: {g: {h: {i: 1}}}}}}}}\n"), "nested deeper"));
  std::string bomb = "a: &a " + std::string(1'000'000, 'x') + "\n";
  for (int k = 0; k < 1000; ++k) bomb += "k" + std::to_string(k) + ": *a\n";
  EXPECT_TRUE(contains(text_error(bomb), "aliases make this scene too large"));
  std::string anchors;
  for (int k = 0; k < 100'000; ++k)
    anchors += "k" + std::to_string(k) + ": &a" + std::to_string(k) + " 1\n";
  EXPECT_EQ(text_error(anchors), "");
}

TEST(SceneText, OnlyRegularFiles) {
  EXPECT_TRUE(contains(error_of([] { read_scene_text(testing::TempDir()); }), "directory"));
  EXPECT_TRUE(contains(error_of([] { read_scene_text("no/such/file.yaml"); }), "No such file"));
  EXPECT_NE(error_of([] { read_scene_text("/dev/null"); }), "");
}

}  // namespace
}  // namespace floe
