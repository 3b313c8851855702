// Prescribed motions of sets that share bodies: they must agree where they prescribe the same.
#include <gtest/gtest.h>

#include <numeric>

#include "floe/options/given.h"
#include "model/model.h"
#include "support/lattices.h"

namespace floe {
namespace {

constexpr std::uint8_t x = 1, y = 2, rz = 32;

/// Fixes x and moves it.
Boundary pull(std::string name, std::string set, double velocity = 0, double ramp = 0) {
  Boundary boundary;
  boundary.name = std::move(name), boundary.set = std::move(set);
  boundary.fixed[0] = true;
  boundary.velocity = Point3{velocity, 0, 0};
  boundary.ramp.seconds = ramp;
  return boundary;
}

/// Five bodies in a row; sets: first, last, all, head (0 to 2), tail (2 to 4).
Lattice row_with_sets() {
  Lattice lattice = test::row(5);
  lattice.sets["head"] = {0, 1, 2};
  lattice.sets["tail"] = {2, 3, 4};
  return lattice;
}

std::string refusal(const Lattice& lattice, const std::vector<Boundary>& boundaries) {
  try {
    (void)prescribed_components(lattice, boundaries);
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

TEST(Boundaries, ComponentsOfAllAreHeld) {
  const Lattice lattice = row_with_sets();
  Boundary head = pull("a", "head"), tail = pull("b", "tail");
  head.fixed[5] = true;
  tail.fixed = {false, true, false, false, false, false};
  using Bits = std::vector<std::uint8_t>;
  EXPECT_EQ(prescribed_components(lattice, {head, tail}), (Bits{x | rz, x | rz, x | y | rz, y, y}));
  EXPECT_EQ(prescribed_components(lattice, {}), Bits(5, 0));
}

TEST(Boundaries, SetsThatShareBodiesMayMoveThemAlike) {
  const Lattice lattice = row_with_sets();
  EXPECT_EQ(refusal(lattice, {pull("a", "head", 2, 3), pull("b", "tail", 2, 3)}), "");
  EXPECT_EQ(refusal(lattice, {pull("a", "head", 2, 3), pull("b", "head", 2, 3)}), "");
  Boundary displaced = pull("b", "tail");
  displaced.velocity.reset(), displaced.displacement = Point3{};
  EXPECT_EQ(refusal(lattice, {pull("a", "head"), displaced}), "");  // both stay where they are
}

TEST(Boundaries, WhatMovesBodiesDifferentlyIsNamed) {
  const Lattice lattice = row_with_sets();
  const auto message = [](int bodies, const char* other) {
    return "boundary: b: prescribes x of " + std::to_string(bodies) +
           " bodies that boundary: " + other + " prescribes differently";
  };
  EXPECT_EQ(refusal(lattice, {pull("a", "head", 1), pull("b", "head", 2)}), message(3, "a"));
  EXPECT_EQ(refusal(lattice, {pull("a", "head", 1), pull("b", "tail", 2)}), message(1, "a"));
  EXPECT_EQ(refusal(lattice, {pull("a", "all", 1), pull("b", "tail", 1, 4)}), message(3, "a"));
  // Not only with the first one before it.
  EXPECT_EQ(refusal(lattice, {pull("a", "head", 1), pull("c", "last", 2), pull("b", "all", 1)}),
            message(1, "c"));
  Boundary turned = pull("b", "tail", 1), held = pull("a", "head", 1);
  turned.fixed[5] = held.fixed[5] = true;
  turned.angular_velocity[2] = 1;
  EXPECT_EQ(refusal(lattice, {held, turned}),
            "boundary: b: prescribes rz of 1 bodies that boundary: a prescribes differently");
}

/// Ten thousand boundaries, each on 100,000 bodies or on its own part of them: pair by pair that
/// would be 10^13 steps.
TEST(Boundaries, ManyOfThemTakeTimeInProportion) {
  constexpr std::int32_t bodies = 100'000, sets = 5'000;
  Lattice lattice;
  lattice.bodies.position.resize(bodies);
  auto& all = lattice.sets["all"];
  all.resize(bodies);
  std::iota(all.begin(), all.end(), 0);
  std::vector<Boundary> boundaries;
  for (std::int32_t k = 0; k < sets; ++k) {
    const std::string name = "s" + std::to_string(k);
    constexpr std::int32_t part = bodies / sets;
    lattice.sets[name] = {all.begin() + k * part, all.begin() + (k + 1) * part};
    boundaries.push_back(pull("a" + name, "all", 1));
    boundaries.push_back(pull("b" + name, name, 1));
  }
  EXPECT_EQ(prescribed_components(lattice, boundaries), std::vector<std::uint8_t>(bodies, x));
  boundaries.push_back(pull("last", "s4321", 2));
  EXPECT_EQ(refusal(lattice, boundaries),
            "boundary: last: prescribes x of 20 bodies that boundary: bs4321 prescribes "
            "differently");
}

}  // namespace
}  // namespace floe
