// ns per beam of the beam forces on a regular-ordered sheet: FloeBench --benchmark_filter=beam
#include <benchmark/benchmark.h>

#include <cmath>

#include "floe/base/petsc.h"
#include "floe/forces/beam.h"
#include "floe/lattice/lattice.h"
#include "floe/lattice/partition.h"

namespace {

using namespace floe;

/// A meshed sheet of about `bodies` bodies with a smooth deformation and motion.
template <class Space>
struct Case {
  Part part;
  State<Space> state;
  Wrenches<Space> wrenches;
  explicit Case(std::int64_t bodies) {
    SheetPlan plan;
    plan.element_size = 1;
    plan.length = plan.width = std::sqrt(static_cast<double>(bodies) * std::sqrt(3.0) / 2);
    plan.iterations = 5;
    Lattice lattice = make_sheet(tessellate(plan, PETSC_COMM_SELF), SheetSection{});
    (void)reorder(lattice);
    part = partition(lattice, PETSC_COMM_SELF);
    state = State<Space>(static_cast<std::size_t>(part.local));
    wrenches = Wrenches<Space>(static_cast<std::size_t>(part.local));
    constexpr int turns = Space::unknowns - Space::translations;
    constexpr int first = Space::rotation + (turns == 3 ? 1 : 0);  // after a quaternion's w
    for (std::size_t b = 0; b < static_cast<std::size_t>(part.local); ++b) {
      const Point3& x = part.bodies.position[b];
      double* r = state.record(b);
      for (int k = 0; k < Space::translations; ++k) {
        r[k] = 1e-3 * std::sin(x[0] + k) * std::cos(x[1]);
        r[Space::velocity + k] = 1e-2 * std::sin(x[1] + k);
      }
      for (int k = 0; k < turns; ++k) r[first + k] = 1e-3 * std::cos(x[0] - k);
    }
  }
};

template <class Space>
void beam(benchmark::State& bench, double damping) {
  Case<Space> c(bench.range(0));
  BeamOptions options;
  options.damping_ratio = damping;
  const auto force = make_beam_force<Space>(c.part, options);
  for (auto _ : bench) {
    force->add(c.state, c.wrenches);
    benchmark::ClobberMemory();
  }
  bench.counters["ns_per_beam"] = benchmark::Counter(
      static_cast<double>(c.part.beams.size()) * 1e-9,
      benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}
void spatial(benchmark::State& bench, double damping) { beam<Spatial>(bench, damping); }
void planar(benchmark::State& bench, double damping) { beam<Planar>(bench, damping); }

void sizes(benchmark::internal::Benchmark* bench) {
  bench->Arg(1460)->Arg(29561)->Unit(benchmark::kMicrosecond);
}
BENCHMARK_CAPTURE(spatial, undamped, 0.0)->Apply(sizes);
BENCHMARK_CAPTURE(spatial, damped, 1.0)->Apply(sizes);
BENCHMARK_CAPTURE(planar, undamped, 0.0)->Apply(sizes);
BENCHMARK_CAPTURE(planar, damped, 1.0)->Apply(sizes);

}  // namespace

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  floe::Mpi mpi(argc, argv);
  floe::Session session(argc, argv, "");
  benchmark::RunSpecifiedBenchmarks();
}
