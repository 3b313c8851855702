// The text of a scene.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "options/scene_text.h"
#include "support/scene_options.h"

namespace floe {
namespace {

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
  std::string long_key(130, 'k');
  long_key += ": 1\n";
  EXPECT_NE(text_error(long_key), "");
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
