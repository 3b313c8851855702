// What a contact costs: pairs that touch, pairs that are near, a heap as it lies.

#include <benchmark/benchmark.h>

#include <cmath>
#include <vector>

#include "active_contacts/contacts.h"

namespace floe {
namespace {

/// Blocks of 8 vertices on a grid, turned a little, that overlap their six neighbours
/// (gap < 0) or do not.
struct Blocks {
  Shapes shapes;
  std::vector<double> masses;
  std::vector<Pose> poses;
  explicit Blocks(int n, double gap, double turn = 0.02) {
    std::uint64_t seed = 1;
    const auto random = [&] {
      seed = seed * 6364136223846793005ULL + 1442695040888963407ULL;
      return static_cast<double>(seed >> 11) * 0x1p-52 - 1;
    };
    for (int k = 0; k < n * n * n; ++k) {
      const auto base = static_cast<std::int32_t>(shapes.vertices.size());
      for (const double z : {-0.5, 0.5})
        for (const double y : {-0.5, 0.5})
          for (const double x : {-0.5, 0.5}) shapes.vertices.push_back({x, y, z});
      for (const std::int32_t c :
           {0, 2, 3, 1, 4, 5, 7, 6, 0, 1, 5, 4, 2, 6, 7, 3, 0, 4, 6, 2, 1, 3, 7, 5})
        shapes.corners.push_back(base + c);
      for (int f = 0; f < 6; ++f) shapes.corner_of.push_back(shapes.corner_of.back() + 4);
      shapes.face_of.push_back(shapes.face_of.back() + 6);
      shapes.vertex_of.push_back(base + 8);
      masses.push_back(920);
      const int layer = k / (n * n), row = k / n % n, column = k % n;
      poses.push_back({(1 + gap) * Vec3<double>{1.0 * column, 1.0 * row, 1.0 * layer},
                       exp_rotation({turn * random(), turn * random(), turn * random()})});
    }
  }
};

/// \param drift  of each body per evaluation, to and fro [m]
void evaluate(benchmark::State& state, double gap, double turn = 0.02, double drift = 0) {
  const Blocks blocks(static_cast<int>(state.range(0)), gap, turn);
  Contacts contacts(blocks.shapes, blocks.masses, {}, {.young = 1e7, .damping_ratio = 0.3}, {});
  contacts.build(blocks.poses, std::vector<std::uint8_t>(blocks.poses.size(), 1), 0);
  std::vector<MovingPose> bodies;
  for (const std::int32_t b : contacts.list().involved())
    bodies.push_back({blocks.poses[static_cast<std::size_t>(b)], {}, {}});
  std::vector<ContactWrench> wrenches(bodies.size());
  const std::vector<Acceleration> accelerations(bodies.size());
  double side = 1;
  for ([[maybe_unused]] auto _ : state) {
    side = -side;
    for (std::size_t b = 0; b < bodies.size(); ++b) bodies[b].pose.x.z += side * drift;
    contacts.place(bodies, 0, 0);
    contacts.evaluate(wrenches);
    contacts.damp(accelerations, wrenches);
    contacts.commit();
  }
  const auto listed = static_cast<double>(contacts.list().size());
  contacts.place(bodies, 0, 0);
  contacts.evaluate(wrenches);
  const auto touching = static_cast<double>(contacts.touching());
  state.counters["listed"] = listed;
  state.counters["touching"] = touching;
  state.counters["us_per_block"] = benchmark::Counter(
      1e-6 * static_cast<double>(blocks.poses.size()),
      benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
  state.counters["us_per_pair"] = benchmark::Counter(
      1e-6 * listed, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}
void touching(benchmark::State& state) { evaluate(state, -0.03); }
/// Apart, each body moving as fast as in rubble that settles: 0.3 m/s with steps of 1 ms.
void near(benchmark::State& state) { evaluate(state, 0.035, 0.02, 3e-4); }
/// Turned at random, about five contacts each: rubble as it lies.
void heap(benchmark::State& state) { evaluate(state, 0.18, 1); }
BENCHMARK(heap)->Arg(10)->Arg(22);
BENCHMARK(touching)->Arg(10)->Arg(22);
BENCHMARK(near)->Arg(10)->Arg(22);

void build(benchmark::State& state) {
  const Blocks blocks(static_cast<int>(state.range(0)), 0.01);
  Contacts contacts(blocks.shapes, blocks.masses, {}, {}, {});
  const std::vector<std::uint8_t> here(blocks.poses.size(), 1);
  for ([[maybe_unused]] auto _ : state) contacts.build(blocks.poses, here, 0);
  state.counters["us_per_body"] = benchmark::Counter(
      1e-6 * static_cast<double>(blocks.poses.size()),
      benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}
BENCHMARK(build)->Arg(10)->Arg(22);

}  // namespace
}  // namespace floe

BENCHMARK_MAIN();
