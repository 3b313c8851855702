// ns per beam of the beam forces on a regular-ordered sheet: FloeBench --benchmark_filter=beam
#include <benchmark/benchmark.h>

#include "floe/forces/beam.h"
#include "sheet.h"

namespace {

using namespace floe;

void beam(benchmark::State& run, double damping) {
  bench::Sheet c(run.range(0));
  BeamOptions options;
  options.damping_ratio = damping;
  const auto force = make_beam_force<Spatial>(c.part, options);
  for (auto _ : run) {
    force->add(c.state, c.wrenches);
    benchmark::ClobberMemory();
  }
  run.counters["ns_per_beam"] = benchmark::Counter(
      static_cast<double>(c.part.beams.size()) * 1e-9,
      benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}
BENCHMARK_CAPTURE(beam, undamped, 0.0)->Arg(1460)->Arg(29561)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(beam, damped, 1.0)->Arg(1460)->Arg(29561)->Unit(benchmark::kMicrosecond);

}  // namespace

int main(int argc, char** argv) { return floe::bench::run(argc, argv); }
