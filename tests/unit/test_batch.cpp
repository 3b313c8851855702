// Runs of several processes whose steps one process makes together: each is what it is alone,
// whoever leaves, and a launch is made for all that are left.
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "device/batch.h"
#include "device/device_stepper.h"
#include "support/dynamics.h"
#include "support/lattices.h"
#include "support/scene_options.h"

namespace floe {
namespace {

using device::Engine;
using device::Steps;

enum class Also { nothing, floats, breaks, holds };

/// A sheet that hangs from its left edge under its weight and a load, in an engine's form. Where
/// its beams may break, it halts at breaks.
struct Sheet {
  Scene scene;
  std::unique_ptr<test::Dynamics> run;
  device::DescribedModel described;
  double dt = 2e-4;

  Sheet(double length, double width, double damping, Also also = Also::nothing) {
    const bool floats = also == Also::floats, breaks = also == Also::breaks;
    scene.forces.beam = scene.forces.gravity = true;
    scene.beam.damping_ratio = damping;
    scene.forces.buoyancy = scene.forces.drag = floats;
    scene.drag.linear = 100;
    scene.water_pace = floats ? 3 : 1;
    scene.forces.fracture = breaks || also == Also::holds;
    scene.fracture.tensile_strength = 2e5, scene.fracture.shear_strength = 1e5;
    scene.fracture.energy = scene.fracture.energy_shear = 1;
    Boundary left;
    left.name = left.set = "left", left.fixed = {true, true, true, false, true, false};
    left.velocity = Point3{0.1, 0, 0};
    scene.boundaries = {left};
    Load load;
    const double factor = breaks ? 2e3 : 1;
    load.name = load.set = "all", load.force = {1e3 * factor, -500 * factor, 2e3 * factor};
    load.moment = {20, 0, -30};
    scene.loads = {load};
    run = std::make_unique<test::Dynamics>(scene, test::sheet(length, width, 1, floats));
    described = device::describe(run->model(), "loop");
    described.lattice.halts_at_breaks = scene.forces.fracture;
  }

  std::vector<double> records() const {
    std::vector<double> all;
    for (const std::int32_t b : described.order) {
      const double* from = run->state().record(static_cast<std::size_t>(b));
      all.insert(all.end(), from, from + Engine::record);
    }
    return all;
  }
  Steps steps(int first, int count) const {
    Steps s{.count = count, .dt = dt, .before = first == 0 ? 0.0 : dt};
    for (int n = first; n < first + count; ++n) {
      for (const double at : {n * dt, n * dt + dt}) {
        const auto values = run->model().boundaries().front().boundary.value(at);
        s.motions.insert(s.motions.end(), values.begin(), values.end());
      }
      const auto wrench = described.numbers.loads.front().wrench(n * dt);
      s.wrenches.insert(s.wrenches.end(), wrench.begin(), wrench.end());
      if (described.lattice.breaking) s.times.push_back(n * dt);
      if (described.lattice.water) s.water.insert(s.water.end(), {0.01 * n, 0.2, 0.1, 0});
    }
    s.since = described.lattice.water ? first % described.lattice.water->pace : 0;
    return s;
  }
};

/// What an engine has told a run.
struct Asked {
  std::vector<double> records, submerged, speeds;
  std::vector<int> steps;
  device::Works works;
  device::Damage damage;

  bool operator==(const Asked& other) const {
    return records == other.records && submerged == other.submerged && speeds == other.speeds &&
           steps == other.steps && damage.cracks == other.damage.cracks &&
           damage.viscous == other.damage.viscous && works.beams == other.works.beams &&
           works.held == other.works.held && works.loaded == other.works.loaded &&
           works.drag == other.works.drag;
  }
};

/// \param counts  of the steps that the run wants at once
Asked ask(Engine& engine, const Sheet& sheet, const std::vector<int>& counts) {
  Asked asked;
  asked.records = sheet.records();
  engine.put(0, asked.records);
  const bool floats = sheet.described.lattice.water.has_value();
  asked.submerged.resize(floats ? 15 * sheet.described.order.size() : 0);
  if (floats) engine.put_submerged(0, asked.submerged);
  if (const auto& breaking = sheet.described.numbers.breaking) {
    breaking->kept->read(asked.damage.cracks, asked.damage.viscous);
    engine.put_damage(0, asked.damage);
  }
  const Steps early = sheet.steps(0, 2);
  engine.step({&early, 1});
  const device::Works works = engine.works(0);
  engine.forget_works(0);
  for (const double work : engine.works(0).loaded) EXPECT_EQ(work, 0);
  engine.put_works(0, works);
  int done = engine.made(0).steps;
  for (const int count : counts) {
    const Steps steps = sheet.steps(done, count);
    engine.step({&steps, 1});
    const device::Made made = engine.made(0);
    asked.steps.push_back(made.why == 0 ? made.steps : -made.steps);
    const device::Findings found = engine.findings(0);
    asked.speeds.push_back(found.speed2);
    asked.speeds.push_back(found.spin2);
    done += made.steps;
  }
  engine.get(0, asked.records);
  if (floats) engine.get_submerged(0, asked.submerged);
  asked.works = engine.works(0);
  if (sheet.described.lattice.breaking) asked.damage = engine.get_damage(0);
  return asked;
}

/// Ends of connections: of the process that makes steps, of its runs.
struct Ends {
  std::vector<int> here, there;

  explicit Ends(std::size_t runs) {
    for (std::size_t r = 0; r < runs; ++r) {
      std::array<int, 2> pair{};
      EXPECT_EQ(::socketpair(AF_UNIX, SOCK_STREAM, 0, pair.data()), 0);
      here.push_back(pair[0]), there.push_back(pair[1]);
    }
  }
};

device::Batch::Maker loop() {
  return [](std::vector<device::Lattice> lattices) {
    return device::make_loop_engine(std::move(lattices), 16);
  };
}

// Three runs of other sizes and numbers of steps; one leaves early, one before it has joined.
TEST(Batch, RunsAreWhatTheyAreAloneInFewLaunches) {
  std::vector<Sheet> sheets;
  sheets.emplace_back(9, 6, 0.1);
  sheets.emplace_back(6, 5, 0.05);
  sheets.emplace_back(7, 7, 0.2);
  const std::vector<std::vector<int>> counts{{5, 1, 7, 3, 4, 2}, {4, 4}, {1, 2, 3, 4, 5, 6}};
  const Ends ends(4);
  device::Batch batch(loop(), ends.here);
  std::thread serving([&] { batch.serve(); });
  std::vector<Asked> together(3);
  std::vector<std::thread> runs;
  for (std::size_t r = 0; r < 3; ++r) {
    runs.emplace_back([&, r] {
      const auto engine = device::join_batch(ends.there[r], sheets[r].described.lattice);
      EXPECT_GT(engine->tiles(), 3);
      together[r] = ask(*engine, sheets[r], counts[r]);
    });
  }
  ::close(ends.there[3]);
  for (std::thread& run : runs) run.join();
  serving.join();
  for (std::size_t r = 0; r < 3; ++r) {
    const auto alone = device::make_loop_engine({sheets[r].described.lattice});
    EXPECT_TRUE(together[r] == ask(*alone, sheets[r], counts[r])) << r;
    EXPECT_NE(together[r].records, sheets[r].records());
    EXPECT_GT(together[r].speeds.at(0), 0);
    EXPECT_NE(together[r].works.loaded.at(3), 0);
  }
  EXPECT_EQ(batch.engines(), 1U);
  EXPECT_EQ(batch.launches(), 1 + 6);  // as many as the run with most has wanted
  EXPECT_EQ(batch.steps(), 2 + 5 + 4 + 7 + 4 + 5 + 6);
}

// A run that halts at breaks wants its other steps with the next ones of the others.
TEST(Batch, RunsHaltAlone) {
  std::vector<Sheet> sheets;
  sheets.emplace_back(7, 6, 0.2, Also::breaks);
  sheets.emplace_back(9, 5, 0.1, Also::holds);
  const std::vector<int> counts(5, 8);
  const Ends ends(2);
  device::Batch batch(loop(), ends.here);
  std::thread serving([&] { batch.serve(); });
  std::vector<Asked> together(2);
  std::vector<std::thread> runs;
  for (std::size_t r = 0; r < 2; ++r) {
    runs.emplace_back([&, r] {
      const auto engine = device::join_batch(ends.there[r], sheets[r].described.lattice);
      together[r] = ask(*engine, sheets[r], counts);
    });
  }
  for (std::thread& run : runs) run.join();
  serving.join();
  for (std::size_t r = 0; r < 2; ++r) {
    const auto alone = device::make_loop_engine({sheets[r].described.lattice});
    EXPECT_TRUE(together[r] == ask(*alone, sheets[r], counts)) << r;
  }
  EXPECT_EQ(batch.engines(), 1U);
  EXPECT_LT(*std::min_element(together[0].steps.begin(), together[0].steps.end()), 0);
  EXPECT_EQ(together[1].steps, counts);
}

// Other forces would be other operations of a device.
TEST(Batch, RunsOfOtherKindsHaveEnginesOfTheirOwn) {
  std::vector<Sheet> sheets;
  sheets.emplace_back(6, 5, 0.1);
  sheets.emplace_back(6, 5, 0);
  sheets.emplace_back(7, 5, 0.2, Also::floats);
  sheets.emplace_back(7, 6, 0.2, Also::breaks);
  sheets.emplace_back(8, 5, 0.3);
  const Ends ends(sheets.size());
  device::Batch batch(loop(), ends.here);
  std::thread serving([&] { batch.serve(); });
  std::vector<std::thread> runs;
  for (std::size_t r = 0; r < sheets.size(); ++r) {
    runs.emplace_back([&, r] {
      const auto engine = device::join_batch(ends.there[r], sheets[r].described.lattice);
      const auto alone = device::make_loop_engine({sheets[r].described.lattice});
      const Asked asked = ask(*engine, sheets[r], {3, 4});
      EXPECT_TRUE(asked == ask(*alone, sheets[r], {3, 4})) << r;
      if (r == 2) {
        EXPECT_NE(asked.works.drag.at(3), 0);
        EXPECT_NE(asked.submerged, std::vector<double>(asked.submerged.size()));
      }
      EXPECT_TRUE(r != 3 || std::any_of(asked.damage.cracks.begin(), asked.damage.cracks.end(),
                                        [](double number) { return number > 0; }));
    });
  }
  for (std::thread& run : runs) run.join();
  serving.join();
  EXPECT_EQ(batch.engines(), 4U);
  EXPECT_EQ(batch.launches(), 4 * 3);
}

/// The error of a run that joins a batch and makes a step.
std::string error_of_run(const device::Batch::Maker& make) {
  const Sheet sheet(4, 4, 0);
  const Ends ends(1);
  device::Batch batch(make, ends.here);
  std::thread serving([&] { batch.serve(); });
  std::string error;
  try {
    const auto engine = device::join_batch(ends.there[0], sheet.described.lattice);
    (void)ask(*engine, sheet, {1});
  } catch (const InputError& e) {
    error = std::string("input: ") + e.what();
  } catch (const device::Failed& e) {
    error = e.what();
  }
  serving.join();
  return error;
}

/// An engine whose steps fail.
struct Broken : Engine {
  void put(std::size_t, std::span<const double>) override {}
  void get(std::size_t, std::span<double>) override {}
  void put_submerged(std::size_t, std::span<const double>) override {}
  void get_submerged(std::size_t, std::span<double>) override {}
  void put_damage(std::size_t, const device::Damage&) override {}
  device::Damage get_damage(std::size_t) override { return {}; }
  void put_pairs(std::size_t, device::Pairs) override {}
  void get_pairs(std::size_t, device::Pairs&) override {}
  bool list_pairs(std::size_t, std::span<const double>) override { return false; }
  std::vector<device::Parted> get_parted(std::size_t) override { return {}; }
  void put_worn(std::size_t, std::span<const device::WornPlane>) override {}
  void put_obstacles(std::size_t, std::span<const double>) override {}
  void get_obstacles(std::size_t, std::span<double>) override {}
  device::Made made(std::size_t) override { return {}; }
  void step(std::span<const Steps>) override { throw device::Failed("CUDA: a kernel: broken"); }
  device::Findings findings(std::size_t) override { return {}; }
  device::Works works(std::size_t) override { return {}; }
  void put_works(std::size_t, const device::Works&) override {}
  void forget_works(std::size_t) override {}
  std::int32_t tiles() const override { return 1; }
};

TEST(Batch, ErrorsComeToTheRuns) {
  EXPECT_EQ(error_of_run([](auto) -> std::unique_ptr<Engine> {
              throw device::Failed("CUDA: the memory of the device is full");
            }),
            "CUDA: the memory of the device is full");
  EXPECT_EQ(error_of_run([](auto) -> std::unique_ptr<Engine> {
              throw InputError("backend: cuda: there is no device");
            }),
            "input: backend: cuda: there is no device");
  EXPECT_EQ(error_of_run([](auto) { return std::make_unique<Broken>(); }),
            "CUDA: a kernel: broken");
  const Sheet sheet(4, 4, 0);
  const Ends ends(1);
  ::close(ends.here[0]);
  try {
    (void)device::join_batch(ends.there[0], sheet.described.lattice);
    ADD_FAILURE() << "joined a batch that has ended";
  } catch (const device::Failed& error) {
    EXPECT_STREQ(error.what(), "the process that makes the steps of a batch has ended");
  }
}

TEST(Batch, AProcessJoinsOnce) {
  EXPECT_FALSE(device::connection_to_batch());
  const Ends ends(1);
  ::setenv(device::batch_variable, std::to_string(ends.there[0]).c_str(), 1);
  EXPECT_EQ(device::connection_to_batch(), ends.there[0]);
  EXPECT_FALSE(device::connection_to_batch());
  for (const char* wrong : {"", "x", "-1", "3x", "99999"}) {
    ::setenv(device::batch_variable, wrong, 1);
    const std::string error = error_of([] { (void)device::connection_to_batch(); });
    EXPECT_TRUE(contains(error, "FLOE_BATCH: '" + std::string(wrong) + "' must be")) << error;
  }
  ::close(ends.here[0]), ::close(ends.there[0]);
}

}  // namespace
}  // namespace floe
