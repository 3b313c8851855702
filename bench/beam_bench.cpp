// ns per beam of the beam forces: build/release/bench/beam_bench --benchmark_filter=planar
// `linear`: with linear kinematics, and the same forces as a product with the assembled matrix.
#include <benchmark/benchmark.h>

#include "beams/beam_force.h"
#include "sheet.h"

namespace {

using namespace floe;

void count(benchmark::State& run, const Part& part) {
  run.counters["ns_per_beam"] = benchmark::Counter(
      static_cast<double>(part.beams.size()) * 1e-9,
      benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

template <class Space>
void beam(benchmark::State& run, const BeamOptions& options) {
  bench::Sheet<Space> c(run.range(0));
  const auto force = make_beam_force<Space>(c.part, options);
  for ([[maybe_unused]] auto _ : run) {
    force->add(c.state, c.wrenches);
    benchmark::ClobberMemory();
  }
  count(run, c.part);
}
BeamOptions with(double damping, Kinematics kinematics = Kinematics::corotational) {
  BeamOptions options;
  options.damping_ratio = damping;
  options.kinematics = kinematics;
  return options;
}
void spatial(benchmark::State& run, const BeamOptions& options) { beam<Spatial>(run, options); }
void planar(benchmark::State& run, const BeamOptions& options) { beam<Planar>(run, options); }

template <class Space>
void product(benchmark::State& run) {
  const bench::Sheet<Space> c(run.range(0));
  const std::vector<std::uint8_t> held(static_cast<std::size_t>(c.part.local), 0);
  Tangent<Space> tangent(c.part, held, 1.0, 1.0, {.type = MATBAIJ});
  tangent.begin();
  const auto beams = make_beam_force<Space>(c.part, with(0, Kinematics::linear));
  (void)beams->roles().tangent->add_tangent(c.state, tangent);
  tangent.end();
  Handle<Vec> x, y;
  check(MatCreateVecs(tangent.matrix(), x.put(), y.put()));
  check(VecSet(x, 1.0));
  for ([[maybe_unused]] auto _ : run) check(MatMult(tangent.matrix(), x, y));
  count(run, c.part);
}
void spatial_matrix(benchmark::State& run) { product<Spatial>(run); }
void planar_matrix(benchmark::State& run) { product<Planar>(run); }

void sizes(benchmark::internal::Benchmark* run) {
  run->Arg(1460)->Arg(29561)->Unit(benchmark::kMicrosecond);
}
BENCHMARK_CAPTURE(spatial, undamped, with(0))->Apply(sizes);
BENCHMARK_CAPTURE(spatial, damped, with(1))->Apply(sizes);
BENCHMARK_CAPTURE(spatial, linear, with(0, Kinematics::linear))->Apply(sizes);
BENCHMARK(spatial_matrix)->Apply(sizes);
BENCHMARK_CAPTURE(planar, undamped, with(0))->Apply(sizes);
BENCHMARK_CAPTURE(planar, damped, with(1))->Apply(sizes);
BENCHMARK_CAPTURE(planar, linear, with(0, Kinematics::linear))->Apply(sizes);
BENCHMARK(planar_matrix)->Apply(sizes);

}  // namespace

int main(int argc, char** argv) { return floe::bench::run(argc, argv); }
