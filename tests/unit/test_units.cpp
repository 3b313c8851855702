// Numbers that look as if units were mistaken, and the command that makes a lattice file.
#include <gtest/gtest.h>

#include <functional>

#include "scene/units.h"
#include "scene_model/lattice_command.h"

namespace floe {
namespace {

/// Everything that is looked at is used, and usual.
Scene usual() {
  Scene scene;
  scene.has_sheet = true;
  scene.forces = {true, true, true, true, false, true};
  scene.sheet.length = scene.sheet.width = 40;
  scene.fracture.tensile_strength = scene.fracture.shear_strength = 6e5;
  scene.fracture.energy = 15;
  scene.contact.young = 1e9;
  return scene;
}

TEST(Units, UsualNumbersAreNotAskedAbout) {
  EXPECT_EQ(unusual_numbers(usual()), std::vector<std::string>{});
}

TEST(Units, AnUnusualNumberIsAskedAbout) {
  struct Case {
    std::function<void(Scene&)> change;
    std::string key, question;
  };
  const std::vector<Case> cases{
      {[](Scene& s) { s.ice.young = 4; }, "ice: young: 4 Pa", "is it meant in GPa?"},
      {[](Scene& s) { s.ice.young = 4000; }, "ice: young: 4000 Pa", "is it meant in MPa?"},
      {[](Scene& s) { s.ice.young = 4e12; }, "ice: young: 4e+12 Pa", "units are SI"},
      {[](Scene& s) { s.ice.density = 0.92; }, "ice: density: 0.92 kg/m^3",
       "is it meant in g/cm^3?"},
      {[](Scene& s) { s.water_density = 1.01; }, "water: density: 1.01 kg/m^3",
       "is it meant in g/cm^3?"},
      {[](Scene& s) { s.thickness = 500; }, "sheet: thickness: 500 m", "is it meant in mm?"},
      {[](Scene& s) { s.thickness = 1e7; }, "sheet: thickness: 1e+07 m", "units are SI"},
      {[](Scene& s) { s.sheet.length = 0.01; }, "sheet: length: 0.01 m", "is it meant in km?"},
      {[](Scene& s) { s.sheet.width = 2e6; }, "sheet: width: 2e+06 m", "is it meant in mm?"},
      {[](Scene& s) { s.gravity = 9810; }, "gravity: 9810 m/s^2", "units are SI"},
      {[](Scene& s) { s.fracture.tensile_strength = 0.6; }, "fracture: tensile_strength: 0.6 Pa",
       "is it meant in MPa?"},
      {[](Scene& s) { s.fracture.shear_strength = 600; }, "fracture: shear_strength: 600 Pa",
       "is it meant in kPa?"},
      {[](Scene& s) { s.fracture.energy = 15000; }, "fracture: energy: 15000 J/m^2",
       "is it meant in mJ/m^2?"},
      {[](Scene& s) { s.contact.young = 1; }, "contact: young: 1 Pa", "is it meant in GPa?"}};
  for (const Case& c : cases) {
    Scene scene = usual();
    c.change(scene);
    const std::vector<std::string> lines = unusual_numbers(scene);
    ASSERT_EQ(lines.size(), 1U) << c.key;
    EXPECT_EQ(lines[0].find(c.key + " is unusual for ice at sea ("), 0U) << lines[0];
    EXPECT_TRUE(lines[0].ends_with(c.question)) << lines[0];
  }
}

TEST(Units, NumbersThatDoNotActAreNotAskedAbout) {
  Scene scene = usual();
  scene.forces = {};
  scene.has_sheet = false;
  scene.ice.young = 4, scene.ice.density = 0.92, scene.water_density = 1.01, scene.gravity = 0.01;
  scene.fracture.energy = 1e9, scene.contact.young = 1, scene.thickness = 1e4;
  EXPECT_EQ(unusual_numbers(scene), std::vector<std::string>{});
}

TEST(LatticeCommand, IsFoundInTheCommentsOfAScene) {
  const std::string file = "out/lattice/strip.h5";
  const std::string make = "floe make_lattice cantilever --length 6 " + file;
  EXPECT_EQ(command_that_makes(file, "# " + make + " && floe input/strip.yaml\nforces: [beam]\n"),
            make);
  EXPECT_EQ(command_that_makes(file, "# A strip.\n#   " + make + "\r\n"), make);
  EXPECT_EQ(command_that_makes(file, "forces: [beam]  # " + make + "\n"), "");
  EXPECT_EQ(command_that_makes(file, "# it is made by somebody else\nlattice_file: " + file), "");
  EXPECT_EQ(command_that_makes(file, "# The strip was made by " + make + "\n"), "");  // no command
  EXPECT_EQ(command_that_makes(file, "# floe pour.yaml && " + make + " && floe strip.yaml\n"),
            "floe pour.yaml && " + make);
  EXPECT_EQ(command_that_makes("strip.h5", "# " + make + "\n"), "");  // another path
  EXPECT_EQ(command_that_makes(file, ""), "");
}

}  // namespace
}  // namespace floe
