// ns per beam of the beam forces: build/release/bench/beam_bench --benchmark_filter=planar
#include <benchmark/benchmark.h>

#include "floe/forces/beam.h"
#include "sheet.h"

namespace {

using namespace floe;

template <class Space>
void beam(benchmark::State& run, double damping) {
  bench::Sheet<Space> c(run.range(0));
  BeamOptions options;
  options.damping_ratio = damping;
  const auto force = make_beam_force<Space>(c.part, options);
  for (auto _ : run) {
    force->add(c.state, c.wrenches);
    benchmark::ClobberMemory();
  }
  run.counters["ns_per_beam"] = benchmark::Counter(
      static_cast<double>(c.part.beams.size()) * 1e-9,
      benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}
void spatial(benchmark::State& run, double damping) { beam<Spatial>(run, damping); }
void planar(benchmark::State& run, double damping) { beam<Planar>(run, damping); }

void sizes(benchmark::internal::Benchmark* run) {
  run->Arg(1460)->Arg(29561)->Unit(benchmark::kMicrosecond);
}
BENCHMARK_CAPTURE(spatial, undamped, 0.0)->Apply(sizes);
BENCHMARK_CAPTURE(spatial, damped, 1.0)->Apply(sizes);
BENCHMARK_CAPTURE(planar, undamped, 0.0)->Apply(sizes);
BENCHMARK_CAPTURE(planar, damped, 1.0)->Apply(sizes);

}  // namespace

int main(int argc, char** argv) { return floe::bench::run(argc, argv); }
