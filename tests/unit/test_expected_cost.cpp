// What a run of a sheet is expected to take, and what is said where that is more than there is.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "floe/options/given.h"
#include "run/expected_cost.h"
#include "scene_model/size_check.h"

namespace floe {
namespace {

/// A floating sheet of 29,561 bodies.
Scene large_sheet(Integrator integrator) {
  Scene scene;
  scene.has_sheet = true;
  scene.integrator = integrator;
  scene.forces.beam = scene.forces.gravity = scene.forces.buoyancy = true;
  scene.sheet.length = scene.sheet.width = 160, scene.sheet.element_size = 1;
  return scene;
}

/// What is said for this much free memory [B]: a warning, or an error.
std::string said(const Scene& scene, double free, int ranks = 1) {
  testing::internal::CaptureStderr();
  try {
    check_size(scene, free, ranks);
  } catch (const InputError& error) {
    (void)testing::internal::GetCapturedStderr();
    return std::string("refused: ") + error.what();
  }
  return testing::internal::GetCapturedStderr();
}

TEST(ExpectedCost, IsThatOfMeasuredRunsToAFactorOfThree) {
  const auto near = [](double expected, double measured) {
    EXPECT_LT(std::abs(std::log(expected / measured)), std::log(3)) << expected << ' ' << measured;
  };
  // Whole runs on one core: unknowns; seconds of a factorisation with its assembly; megabytes.
  near(factorisation_cost(3285 * 6, 1).seconds, 0.12);
  near(factorisation_cost(29561 * 6, 1).seconds, 2);
  near(factorisation_cost(29561 * 3, 1).seconds, 0.6);
  near(factorisation_cost(8541 * 6, 1).bytes, 118e6);
  near(factorisation_cost(29561 * 6, 1).bytes, 457e6);
  near(factorisation_cost(29561 * 3, 1).bytes, 139e6);
  near(lattice_bytes(29561, 1), 103e6);
  near(lattice_bytes(29561, 2), 180e6);
  near(lattice_bytes(1e6, 1), 1.9e9);
}

TEST(ExpectedCost, GrowsFasterThanTheSheetAndLessOnMoreRanks) {
  const FactorisationCost one = factorisation_cost(1e5, 1), ten = factorisation_cost(1e6, 1);
  EXPECT_GT(ten.seconds, 10 * one.seconds);
  EXPECT_GT(ten.bytes, 10 * one.bytes);
  EXPECT_LT(factorisation_cost(1e6, 2).seconds, ten.seconds);
  EXPECT_GT(factorisation_cost(1e6, 2).seconds, ten.seconds / 2);
}

TEST(ExpectedCost, OfASheetIsComparedWithWhatIsFree) {
  const Scene explicit_run = large_sheet(Integrator::explicit_),
              static_run = large_sheet(Integrator::quasistatic);
  EXPECT_EQ(said(explicit_run, 1e9), "");
  EXPECT_EQ(said(static_run, 1e9), "");
  EXPECT_EQ(said(explicit_run, std::numeric_limits<double>::infinity()), "");
  const std::string warned = said(static_run, 3e8);
  EXPECT_EQ(warned.find("floe: warning: sheet: about 29561 bodies would take about "), 0U);
  EXPECT_NE(warned.find("of memory (to a factor of 3), 300 MB are free"), std::string::npos);
  const std::string refused = said(static_run, 1e8);
  EXPECT_EQ(refused.find("refused: sheet: about 29561 bodies would take about "), 0U) << refused;
  EXPECT_NE(refused.find("of memory, 100 MB are free (limit: memory)"), std::string::npos);
  EXPECT_EQ(said(explicit_run, 1e8).find("floe: warning:"), 0U);
  EXPECT_EQ(said(explicit_run, 1e8, 8).find("refused:"), 0U);  // each rank builds all of it
}

TEST(ExpectedCost, OfASheetIsComparedWithTheScenesLimit) {
  Scene scene = large_sheet(Integrator::explicit_);
  scene.limit.memory = 0.05;
  EXPECT_NE(said(scene, 1e12).find("at most 50 MB are taken (limit: memory)"), std::string::npos);
  scene.limit.memory = 10;  // whatever is free
  EXPECT_EQ(said(scene, 1e6).find("floe: warning:"), 0U);
}

TEST(ExpectedCost, FreeMemoryIsKnownHere) {
  const double free = free_memory(PETSC_COMM_SELF);
  EXPECT_GT(free, 0);
  EXPECT_LT(free, 1e17);
}

}  // namespace
}  // namespace floe
