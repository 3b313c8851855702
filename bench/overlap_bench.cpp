// What an overlap costs, placing included: by Clipper, and by GraphClipper in a full pass and in a
// replay.

#include <benchmark/benchmark.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "contact/solids.h"
#include "geometry/graph_clipper.h"

namespace floe {
namespace {

/// Plates of six sides that touch in pairs, as the pieces of a broken sheet do: the first of each
/// pair lies in the frame of the second, turned at random, and reaches into it by some 1 % of its
/// size.
class Plates {
 public:
  explicit Plates(int pairs) : solids_(shapes(2 * pairs), std::vector<double>(2 * pairs, 1), {}) {
    Clipper clipper;
    for (std::int32_t k = 0; k < pairs; ++k) {
      const Quat<double> q = exp_rotation({random(3), random(3), random(3)});
      const Vec3<double> way{random(1), random(1), random(0.5)};
      double apart = 4, touching = 0;
      for (int halving = 0; halving < 40; ++halving) {
        const double middle = 0.5 * (apart + touching);
        const bool overlap = by_loops(clipper, {k, middle * way, q}, false).volume > 0;
        (overlap ? touching : apart) = middle;
      }
      places_.push_back({k, (touching - 0.01) * way, q});
    }
  }

  struct Place {
    std::int32_t pair;
    Vec3<double> x;
    Quat<double> q;
  };
  std::vector<Place>& places() { return places_; }

  Overlap by_loops(Clipper& clipper, const Place& at, bool with_patch) {
    const Triad<double> axes = triad(at.q);
    placed_.clear();
    for (const Vec3<double>& r : solids_.vertices(2 * at.pair))
      placed_.push_back(at.x + axes.to_world(r));
    return clipper.overlap(solids_.shapes(), 2 * at.pair, placed_, solids_.planes(2 * at.pair + 1),
                           with_patch);
  }
  Overlap by_graph(GraphClipper& clipper, const Place& at, bool with_patch, CutRecord& record) {
    Overlap found;
    clipper.place(solids_.vertex_lists(2 * at.pair), triad(at.q), at.x);
    clipper.overlap(*solids_.graph(2 * at.pair), solids_.planes(2 * at.pair + 1), with_patch, {},
                    record, found);
    return found;
  }

 private:
  double random(double size) {
    seed_ = seed_ * 6364136223846793005ULL + 1442695040888963407ULL;
    return size * (static_cast<double>(seed_ >> 11) * 0x1p-52 - 1);
  }
  Shapes shapes(int bodies) {
    Shapes shapes;
    for (int b = 0; b < bodies; ++b) {
      std::vector<Point2> polygon;
      for (int k = 0; k < 6; ++k) {
        const double angle = std::numbers::pi * (k / 3.0 + random(0.05));
        polygon.push_back({0.8 * std::cos(angle), 0.8 * std::sin(angle)});
      }
      append_prism(shapes, polygon, -0.25, 0.25);
    }
    return shapes;
  }

  std::uint64_t seed_ = 1;
  Solids solids_;
  std::vector<Place> places_;
  std::vector<Vec3<double>> placed_;
};

constexpr int pairs = 1400;

/// Times one way to find all overlaps, of plates that drift to and fro by 1e-4 of their size.
template <class Find>
void find_all(benchmark::State& state, Find find) {
  Plates plates(pairs);
  double side = 1e-4;
  for ([[maybe_unused]] auto _ : state) {
    side = -side;
    for (Plates::Place& at : plates.places()) {
      at.x.x += side;
      benchmark::DoNotOptimize(find(plates, at, state.range(0) != 0));
    }
  }
  state.counters["us_per_overlap"] = benchmark::Counter(
      1e-6 * pairs, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void loops(benchmark::State& state) {
  Clipper clipper;
  find_all(state, [&](Plates& plates, const Plates::Place& at, bool with_patch) {
    return plates.by_loops(clipper, at, with_patch).volume;
  });
}
void full_pass(benchmark::State& state) {
  GraphClipper clipper;
  CutRecord record;
  find_all(state, [&](Plates& plates, const Plates::Place& at, bool with_patch) {
    record.cuts = 0;
    return plates.by_graph(clipper, at, with_patch, record).volume;
  });
}
void replay(benchmark::State& state) {
  GraphClipper clipper;
  std::vector<CutRecord> records(pairs);
  find_all(state, [&](Plates& plates, const Plates::Place& at, bool with_patch) {
    CutRecord& record = records[static_cast<std::size_t>(at.pair)];
    return plates.by_graph(clipper, at, with_patch, record).volume;
  });
}
BENCHMARK(loops)->ArgName("patch")->Arg(0)->Arg(1);
BENCHMARK(full_pass)->ArgName("patch")->Arg(0)->Arg(1);
BENCHMARK(replay)->ArgName("patch")->Arg(0)->Arg(1);

}  // namespace
}  // namespace floe

BENCHMARK_MAIN();
