// Options: text to value, names, the table of the scene's keys.
#include <gtest/gtest.h>

#include <map>
#include "floe/options/options.h"
#include "floe/scene/keys.h"
#include "options/option_names.h"
#include "options/option_values.h"
#include "support/scene_options.h"

namespace floe {
namespace {

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

}  // namespace
}  // namespace floe
