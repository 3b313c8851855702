/// \file
/// Scenes from text, and what is said of bad ones.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "floe/options/options.h"
#include "floe/scene.h"
#include "options/scene_text.h"

namespace floe {

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

inline bool contains(const std::string& text, const std::string& part) {
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

}  // namespace floe
