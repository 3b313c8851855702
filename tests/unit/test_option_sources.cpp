// Options of the command line over a scene's, those of the environment, and PETSc's.
#include <gtest/gtest.h>

#include <array>

#include "floe/options/options.h"
#include "floe/session/command_line.h"
#include "floe/session/unused_options.h"
#include "options/spelling.h"
#include "session/environment.h"
#include "support/scene_options.h"

namespace floe {
namespace {

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

TEST(OptionSources, OfTwoKeysThatExcludeEachOtherTheStrongerSourcesCounts) {
  constexpr std::array table{OptionSpec{"a", Kind::number, "", "", "", ""},
                             OptionSpec{"b", Kind::number, "", "", "", ""}};
  constexpr std::array sources{Source::checkpoint, Source::scene, Source::command_line};
  for (const Source of_a : sources) {
    for (const Source of_b : sources) {
      UserOptions user;
      const auto give = [&](const char* name, Source source) {
        GivenOptions& options = source == Source::checkpoint ? user.checkpoint
                                : source == Source::scene    ? user.scene
                                                             : user.command_line;
        options[name] = {.value = "1", .source = source, .place = {}};
      };
      give("a", of_a);
      give("b", of_b);
      Options options(table, user, Options::Idle::kept);
      if (of_a == of_b) {
        EXPECT_EQ(error_of([&] { options.one_of("a", "b", {}, "both"); }), "both");
      } else {
        EXPECT_EQ(options.one_of("a", "b", {}, "both"), of_a > of_b ? "a" : "b");
      }
    }
  }
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
  EXPECT_TRUE(contains(command_line_error({"-check", "a.yaml"}), "floe a.yaml -check"));
}

TEST(CommandLine, AnOptionInFrontOfTheSceneIsToldHowToStand) {
  EXPECT_EQ(command_line_error({"-sheet_length", "3", "a.yaml", "-check"}),
            "the scene's file comes first, options after it; -sheet_length is an option: floe "
            "a.yaml -sheet_length 3 -check");
  EXPECT_TRUE(contains(command_line_error({"-sheet_length", "3"}), "no scene is named; usage"));
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

}  // namespace
}  // namespace floe
