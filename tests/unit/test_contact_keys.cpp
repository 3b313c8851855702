// What a scene says of crushing, friction below water and new faces.
#include <gtest/gtest.h>

#include <string>

#include "support/scene_options.h"

namespace floe {
namespace {

using ContactKeys = SceneOptions;

std::string with(const std::string& contact, const std::string& wall = {}) {
  return "integrator: explicit\nforces: [beam, contact]\nsheet: {length: 40}\ncontact: {" +
         contact +
         "}\nobstacle: {names: [wall], wall: {shape: halfspace, point: [30, 0, 0], "
         "normal: [-1, 0, 0]" +
         wall + "}}\n";
}

TEST_F(ContactKeys, PlasticLimit) {
  const Scene none = scene_of(with(""));
  EXPECT_FALSE(none.contact.plastic_limit.given());
  const Scene plain = scene_of(with("plastic_limit: 2e6"));
  EXPECT_EQ(plain.contact.plastic_limit.pressure, 2e6);
  EXPECT_EQ(plain.contact.plastic_limit.exponent, 0);
  EXPECT_EQ(plain.contact.plastic_limit.fast, 1);
  EXPECT_TRUE(plain.contact.wear);
  const Scene all = scene_of(
      with("plastic_limit: 7.4e6, plastic_exponent: 0.7, plastic_area: 2, plastic_least: 1.48e6, "
           "plastic_most: 20e6, plastic_fast: 0.5, plastic_speed: 0.05, wear: false"));
  const PlasticLimit& limit = all.contact.plastic_limit;
  EXPECT_EQ(limit.exponent, 0.7);
  EXPECT_EQ(limit.area, 2);
  EXPECT_EQ(limit.least, 1.48e6);
  EXPECT_EQ(limit.most, 20e6);
  EXPECT_EQ(limit.fast, 0.5);
  EXPECT_EQ(limit.speed, 0.05);
  EXPECT_FALSE(all.contact.wear);
}

TEST_F(ContactKeys, PlasticLimitRefusesWhatHasNoEffect) {
  const auto refuses = [&](const std::string& contact, const std::string& words) {
    const std::string said = scene_error(with(contact));
    EXPECT_TRUE(contains(said, words)) << contact << ": " << said;
  };
  refuses("plastic_limit: 2e6, plastic_exponent: 1",
          "contact: plastic_exponent: 1 must be a number >= 0, <= 0.99");
  refuses("plastic_limit: 2e6, plastic_exponent: 0.5, plastic_least: 3e6, plastic_most: 1e6",
          "contact: plastic_least: 3e+06 must be <= 1e+06 [Pa]");
  refuses("plastic_limit: 2e6, plastic_fast: 0.5", "contact: plastic_speed");
}

TEST_F(ContactKeys, FrictionBelowWater) {
  const Scene none = scene_of(with("friction: 0.3"));
  EXPECT_FALSE(none.contact.friction_wet.has_value());
  EXPECT_FALSE(none.obstacles[0].friction_wet.has_value());
  const Scene both = scene_of(with("friction: 0.3, friction_wet: 0.05"));
  EXPECT_EQ(both.contact.friction_wet.value(), 0.05);
  EXPECT_EQ(both.obstacles[0].friction_wet.value(), 0.05);
  const Scene own = scene_of(with("friction: 0.3, friction_wet: 0.05", ", friction: 0.2"));
  EXPECT_FALSE(own.obstacles[0].friction_wet.has_value());
  const Scene wall = scene_of(with("friction: 0.3", ", friction_wet: 0.01"));
  EXPECT_EQ(wall.obstacles[0].friction_wet.value(), 0.01);
  EXPECT_FALSE(wall.contact.friction_wet.has_value());
}

TEST_F(ContactKeys, NewFaces) {
  EXPECT_FALSE(scene_of(with("")).contact.young_broken.has_value());
  EXPECT_EQ(scene_of(with("young: 1e8, young_broken: 4e9")).contact.young_broken.value(), 4e9);
}

}  // namespace
}  // namespace floe
