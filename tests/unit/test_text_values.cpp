// Texts that go into messages, paths and options.yaml: of one line, printable, UTF-8.
#include <gtest/gtest.h>

#include <array>
#include <string>

#include "floe/base/petsc.h"
#include "floe/lattice/lattice.h"
#include "floe/session/command_line.h"
#include "options/scene_text.h"

namespace {

using namespace floe;

template <class Function>
std::string error_of(Function&& function) {
  try {
    function();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

std::string error_of_words(const char* scene, const char* value) {
  const std::array words{"floe", scene, "-output_dir", value};
  return error_of([&] { read_command_line(static_cast<int>(words.size()), words.data()); });
}

TEST(TextValues, OfTheCommandLine) {
  EXPECT_EQ(error_of_words("s.yaml", "Ergebnisse für März"), "");
  EXPECT_EQ(error_of_words("s.yaml", "日本/a b/🧊"), "");
  EXPECT_EQ(error_of_words("s.yaml", "a\nb"),
            "-output_dir: 'a b' has a character that cannot be printed");
  EXPECT_EQ(error_of_words("s.yaml", "\x1b[31m"),
            "-output_dir: ' [31m' has a character that cannot be printed");
  EXPECT_NE(error_of_words("s.yaml", "a\x7f"), "");
  for (const char* bytes : {"a\xff", "\xe4pfel", "\xc0\x80", "\xed\xa0\x80", "\xf0\x9f"})
    EXPECT_NE(error_of_words("s.yaml", bytes).find("is not a text in UTF-8"), std::string::npos)
        << bytes;
  EXPECT_NE(error_of_words("s\xff.yaml", "a").find("its name is not a text in UTF-8"),
            std::string::npos);
  EXPECT_NE(error_of_words("s\n.yaml", "a"), "");
}

TEST(TextValues, OfAScene) {
  const auto value = [](const std::string& text) {
    return parse_scene("s.yaml", "a: " + text).at("a").value;
  };
  EXPECT_EQ(value("|\n  x y\n  z\n"), "x y z");
  EXPECT_EQ(value(">\n  x\n  y\n"), "x y");
  EXPECT_EQ(value("'x\n\n  y'\n"), "x y");
  EXPECT_EQ(value("\"x\\ty\"\n"), "x y");
  EXPECT_EQ(value("' x '\n"), " x ");
  for (const auto* bad :
       {"\"\\x07\"\n", "\"\\0\"\n", "\"a\\e[31m\"\n", "[1, \"\\a\"]\n", "\"\\x7f\"\n"})
    EXPECT_NE(error_of([&] { value(bad); }).find("s.yaml: line 1: a: "), std::string::npos) << bad;
}

/// Sets may have names of any length, and there may be many.
TEST(TextValues, OfSets) {
  Lattice lattice;
  for (int k = 0; k < 1000; ++k) lattice.sets["set" + std::to_string(k)] = {0};
  lattice.sets["odd\nname"] = {};
  const auto said = [&](const std::string& name) {
    return error_of([&] { (void)lattice.set(name, "load: p: set"); });
  };
  EXPECT_EQ(said("set7"), "");
  EXPECT_EQ(said("odd\nname"), "load: p: set: the set 'odd name' has no bodies");
  EXPECT_NE(
      said("zet77").find("there is no set 'zet77' (is it 'set77'?); the scene has 'odd name', "
                         "set0, "),
      std::string::npos);
  EXPECT_NE(said("zet77").find(" and 989 more"), std::string::npos);
  EXPECT_LT(said(std::string(10000, 'x')).size(), 400U);
}

}  // namespace
