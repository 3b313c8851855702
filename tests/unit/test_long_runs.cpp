// Runs of more steps than PETSc can count: in pieces, as if they were one.
#include <gtest/gtest.h>

#include <cstring>
#include <string>
#include <vector>

#include "explicit/explicit.h"
#include "explicit/leapfrog.h"
#include "implicit/liealpha.h"
#include "run/dynamic_run.h"
#include "support/implicit_run.h"
#include "support/lattices.h"

namespace floe::test {
namespace {

/// Pieces of so many steps during its life.
class Pieces {
 public:
  explicit Pieces(std::int64_t steps) { steps_of_a_piece = steps; }
  ~Pieces() { steps_of_a_piece = whole; }
  Pieces(const Pieces&) = delete;
  Pieces& operator=(const Pieces&) = delete;

 private:
  static inline const std::int64_t whole = steps_of_a_piece;
};

struct Seen {
  RunResult result;
  std::vector<double> times, records;  ///< of all samples
  bool operator==(const Seen& other) const {
    return times == other.times && records.size() == other.records.size() &&
           std::memcmp(records.data(), other.records.data(), records.size() * sizeof(double)) == 0;
  }
};

enum class By { leapfrog, rk, adaptive_rk, fixed_steps, adaptive_steps };

Seen run(
    By by, const std::function<void(DynamicOptions&)>& change = [](DynamicOptions&) {}) {
  Scene scene;
  scene.forces.beam = true;
  scene.beam.damping_ratio = 0.1;
  Load load;
  load.name = "p", load.set = "last", load.force = {3, 2, 1}, load.ramp.seconds = 0.1;
  scene.loads = {load};
  const Lattice lattice = row(5);
  Model<Spatial> model(lattice, PETSC_COMM_SELF, {});
  add_forces(scene, place_loads(scene, lattice), model);
  ExplicitOptions options;
  options.end = 0.5;
  options.history = 0.02;
  if (by != By::adaptive_steps && by != By::adaptive_rk) options.dt = 1e-3;
  if (by == By::fixed_steps) options.dt = 0.01;
  change(options);
  Seen seen;
  const auto look = [&](const Accepted<Spatial>& a) {
    seen.times.push_back(a.state.time);
    seen.records.insert(seen.records.end(), a.state.records.begin(), a.state.records.end());
  };
  const std::string type = by == By::leapfrog                      ? ts_leapfrog
                           : by == By::rk || by == By::adaptive_rk ? "rk"
                                                                   : ts_liealpha;
  const PetscOption chosen("-ts_type", type);
  if (by == By::adaptive_rk) {
    const PetscOption method("-ts_rk_type", "5dp"), adapt("-ts_adapt_type", "basic"),
        error("-ts_atol", "1e-7");
    seen.result = run_explicit<Spatial>(model, options, look);
  } else if (by == By::leapfrog || by == By::rk) {
    seen.result = run_explicit<Spatial>(model, options, look);
  } else {
    seen.result = run_implicit(model, options, look);
  }
  return seen;
}

TEST(LongRuns, PiecesAreAsOneRunBitForBit) {
  for (const By by : {By::leapfrog, By::rk, By::adaptive_rk, By::fixed_steps, By::adaptive_steps}) {
    SCOPED_TRACE(static_cast<int>(by));
    const Seen whole = run(by);
    ASSERT_TRUE(whole.result.done) << whole.result.message;
    ASSERT_GT(whole.result.steps, 10);
    for (const std::int64_t length : {2, 5, 7}) {  // 5 divides the steps of a sample
      const Pieces pieces(length);
      const Seen parts = run(by);
      EXPECT_TRUE(parts.result.done) << parts.result.message;
      EXPECT_EQ(parts.result.steps, whole.result.steps);
      EXPECT_EQ(parts.result.newton_iterations, whole.result.newton_iterations);
      EXPECT_TRUE(parts == whole);
    }
  }
}

TEST(LongRuns, MostStepsEndThemWhereverAPieceDoes) {
  const PetscOption most("-ts_max_steps", "14");
  for (const By by : {By::leapfrog, By::rk, By::fixed_steps}) {
    SCOPED_TRACE(static_cast<int>(by));
    for (const std::int64_t length : {3, 7, 14, 15, 1000}) {
      const Pieces pieces(length);
      const Seen seen = run(by);
      EXPECT_TRUE(seen.result.done);
      EXPECT_EQ(seen.result.steps, 14);
      EXPECT_NEAR(seen.times.back(), 14 * seen.result.dt, 1e-12);
    }
  }
}

/// PETSc's own reader of the option stops at 2^31 - 1.
TEST(LongRuns, MostStepsMayBeMoreThanPetscCounts) {
  const PetscOption most("-ts_max_steps", "5000000000");
  const Seen seen = run(By::leapfrog);
  EXPECT_TRUE(seen.result.done);
  EXPECT_EQ(seen.result.steps, 500);
}

TEST(LongRuns, MostStepsAreACount) {
  for (const char* value : {"-5", "nan", "3.5", "abc", "", "7 ", "1e3", "99999999999999999999"}) {
    const PetscOption most("-ts_max_steps", value);
    EXPECT_THROW((void)run(By::leapfrog), InputError) << value;
  }
}

}  // namespace
}  // namespace floe::test
