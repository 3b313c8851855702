// What a contact costs: pairs that touch, pairs that are near, a heap as it lies.

#include <benchmark/benchmark.h>

#include <cmath>
#include <numbers>
#include <optional>
#include <type_traits>
#include <vector>

#include "active_contacts/contacts.h"

namespace floe {
namespace {

double random_number() {
  static std::uint64_t seed = 1;
  seed = seed * 6364136223846793005ULL + 1442695040888963407ULL;
  return static_cast<double>(seed >> 11) * 0x1p-52 - 1;
}

/// Pieces of a broken sheet of 0.5 m that touch in pairs, each pair apart from the others: plates
/// of six sides, the first of each pair turned at random, which reaches into the second by 1 cm.
struct TouchingPlates {
  Shapes shapes;
  std::vector<double> masses;
  std::vector<Pose> poses;
  explicit TouchingPlates(int pairs) {
    for (int b = 0; b < 2 * pairs; ++b) {
      std::vector<Point2> polygon;
      for (int k = 0; k < 6; ++k) {
        const double angle = std::numbers::pi * (k / 3.0 + 0.05 * random_number());
        polygon.push_back({0.8 * std::cos(angle), 0.8 * std::sin(angle)});
      }
      append_prism(shapes, polygon, -0.25, 0.25);
      masses.push_back(700);
    }
    const Solids solids(shapes, masses, {});
    Clipper clipper;
    std::vector<Vec3<double>> placed;
    for (std::int32_t k = 0; k < pairs; ++k) {
      const Quat<double> q =
          exp_rotation({3 * random_number(), 3 * random_number(), 3 * random_number()});
      const Vec3<double> way{random_number(), random_number(), 0.5 * random_number()};
      double apart = 4, touching = 0;
      for (int halving = 0; halving < 40; ++halving) {
        const double middle = 0.5 * (apart + touching);
        placed.clear();
        for (const Vec3<double>& r : solids.vertices(2 * k))
          placed.push_back(middle * way + triad(q).to_world(r));
        const bool overlap =
            clipper.overlap(shapes, 2 * k, placed, solids.planes(2 * k + 1), false).volume > 0;
        (overlap ? touching : apart) = middle;
      }
      const Vec3<double> place{5.0 * (k % 40), 5.0 * (k / 40), -1};
      poses.push_back({place + (touching - 0.01) * way, q});
      poses.push_back({place, {1, 0, 0, 0}});
    }
  }
};

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

/// \param drift  of each body, or of the first of each pair, per evaluation, to and fro [m]
template <class Bodies>
void evaluate(benchmark::State& state, const Bodies& blocks, const ContactOptions& options,
              double drift) {
  constexpr bool in_pairs = std::is_same_v<Bodies, TouchingPlates>;
  Contacts contacts(blocks.shapes, blocks.masses, {}, options, {});
  contacts.build(blocks.poses, std::vector<std::uint8_t>(blocks.poses.size(), 1), 0);
  std::vector<MovingPose> bodies;
  for (const std::int32_t b : contacts.list().involved())
    bodies.push_back({blocks.poses[static_cast<std::size_t>(b)], {}, {}});
  std::vector<ContactWrench> wrenches(bodies.size());
  const std::vector<Acceleration> accelerations(bodies.size());
  constexpr double speed = 0.3;  // [m/s]
  double side = 1, time = 0;
  if constexpr (in_pairs) {
    for (std::size_t b = 0; b < bodies.size(); ++b)
      bodies[b].velocity = {speed * random_number(), speed * random_number(), 0};
  }
  const auto step = [&] {
    side = -side;
    for (std::size_t b = 0; b < bodies.size(); b += in_pairs ? 2 : 1)
      bodies[b].pose.x.z += side * drift;
    time += drift / speed;
    contacts.place(bodies, time, time);
    contacts.evaluate(wrenches);
    contacts.damp(accelerations, wrenches);
    contacts.commit();
  };
  step();  // the first gets its memory from the system, which takes ten times longer
  for ([[maybe_unused]] auto _ : state) step();
  const auto listed = static_cast<double>(contacts.list().size());
  contacts.place(bodies, time, time);
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
const ContactOptions of_blocks{.young = 1e7, .damping_ratio = 0.3};
void touching(benchmark::State& state) {
  evaluate(state, Blocks(static_cast<int>(state.range(0)), -0.03), of_blocks, 0);
}
/// Apart, each body moving as fast as in rubble that settles: 0.3 m/s with steps of 1 ms.
void near(benchmark::State& state) {
  evaluate(state, Blocks(static_cast<int>(state.range(0)), 0.035), of_blocks, 3e-4);
}
/// Turned at random, about five contacts each: rubble as it lies.
void heap(benchmark::State& state) {
  evaluate(state, Blocks(static_cast<int>(state.range(0)), 0.18, 1), of_blocks, 0);
}
/// Touching pairs alone, as in the pile of input/ice_slope.yaml: place, overlap, law with springs
/// of friction and dashpots, commit. With drift overlaps are replayed, as in a run.
void pair(benchmark::State& state, std::optional<double> friction_wet, double damping) {
  evaluate(state, TouchingPlates(static_cast<int>(state.range(0))),
           {.young = 1e8,
            .friction = 0.2,
            .friction_wet = friction_wet,
            .damping_ratio = damping,
            .plastic_limit = {.pressure = 1.5e6}},
           1e-4);
}
BENCHMARK_CAPTURE(pair, damped, std::nullopt, 0.3)->Arg(1400);
BENCHMARK_CAPTURE(pair, damped_wet, 0.1, 0.3)->Arg(1400);
BENCHMARK_CAPTURE(pair, undamped, std::nullopt, 0.0)->Arg(1400);
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
