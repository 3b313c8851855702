// ns per body of the water's forces on a slightly tilted floating sheet: buoyancy and drag.
#include <benchmark/benchmark.h>

#include <cmath>

#include "floe/base/petsc.h"
#include "floe/forces/buoyancy.h"
#include "floe/forces/drag.h"

namespace {

using namespace floe;

struct Case {
  Part part;
  State<Spatial> state;
  Wrenches<Spatial> wrenches;
  explicit Case(std::int64_t bodies) {
    SheetPlan plan;
    plan.element_size = 1;
    plan.length = plan.width = std::sqrt(static_cast<double>(bodies) * std::sqrt(3.0) / 2);
    plan.iterations = 5;
    Lattice lattice = make_sheet(tessellate(plan, PETSC_COMM_SELF), SheetSection{});
    (void)reorder(lattice);
    part = partition(lattice, PETSC_COMM_SELF);
    state = State<Spatial>(static_cast<std::size_t>(part.local));
    wrenches = Wrenches<Spatial>(static_cast<std::size_t>(part.local));
    for (std::size_t b = 0; b < static_cast<std::size_t>(part.local); ++b) {
      const Point3& x = part.bodies.position[b];
      double* r = state.record(b);
      for (int k = 0; k < 3; ++k) {
        r[k] = 1e-3 * std::sin(x[0] + k) * std::cos(x[1]);
        r[Spatial::rotation + 1 + k] = 1e-3 * std::cos(x[0] - k);
        r[Spatial::velocity + k] = 1e-2 * std::sin(x[1] + k);
      }
    }
  }
};

void evaluate(benchmark::State& run, const Force<Spatial>& force, Case& c) {
  for (auto _ : run) {
    force.add(c.state, c.wrenches);
    benchmark::DoNotOptimize(c.wrenches.values.data());
  }
  run.counters["ns_per_body"] =
      benchmark::Counter(static_cast<double>(run.iterations()) * c.part.owned * 1e-9,
                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

void buoyancy(benchmark::State& run) {
  Case c(run.range(0));
  evaluate(run, *make_buoyancy<Spatial>(c.part, 1010 * 9.81), c);
}
void drag_linear(benchmark::State& run) {
  Case c(run.range(0));
  evaluate(run, *make_drag<Spatial>(c.part, {.linear = 100}), c);
}
void drag_quadratic(benchmark::State& run) {
  Case c(run.range(0));
  evaluate(run, *make_drag<Spatial>(c.part, {.coefficient = 1}), c);
}
BENCHMARK(buoyancy)->Arg(1460)->Arg(29561);
BENCHMARK(drag_linear)->Arg(1460)->Arg(29561);
BENCHMARK(drag_quadratic)->Arg(1460)->Arg(29561);

}  // namespace

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  floe::Mpi mpi(argc, argv);
  floe::Session session(argc, argv, "");
  benchmark::RunSpecifiedBenchmarks();
}
