// Time of one sweep of the mesh's relaxation, of a triangulation from scratch, and of a whole mesh.
// mesh_bench [--benchmark_filter=...]; the label is the number of cells.
#include <benchmark/benchmark.h>

#include "floe/base/petsc.h"
#include "floe/lattice/lattice.h"
#include "floe/mesh/tessellation.h"
#include "floe/session/session.h"
#include "mesh/relaxation.h"
#include "mesh/voronoi.h"

namespace {

using namespace floe;

/// Plan of edge `length`, elements of 1 m; 160 m make the paper's 29,561 cells.
SheetPlan plan_of(std::int64_t length, int iterations) {
  SheetPlan plan;
  plan.length = plan.width = static_cast<double>(length);
  plan.element_size = 1;
  plan.iterations = iterations;
  return plan;
}

void label(benchmark::State& state, std::size_t cells) {
  state.SetLabel(std::to_string(cells) + " cells");
  state.counters["per_cell"] =
      benchmark::Counter(static_cast<double>(cells) * static_cast<double>(state.iterations()),
                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

void lloyd_sweep(benchmark::State& state) {
  const SheetPlan plan = plan_of(state.range(0), 30);
  mesh::Voronoi voronoi(plan, tessellate(plan, MPI_COMM_SELF).generators, mesh::Share());
  SheetPlan one = plan;
  one.iterations = 1;
  for ([[maybe_unused]] const auto _ : state) mesh::lloyd(voronoi, one, {});
  label(state, voronoi.cells().size());
}
BENCHMARK(lloyd_sweep)->Arg(40)->Arg(160)->Arg(480)->Unit(benchmark::kMillisecond);

void triangulation_from_scratch(benchmark::State& state) {
  const SheetPlan plan = plan_of(state.range(0), 30);
  const auto generators = tessellate(plan, MPI_COMM_SELF).generators;
  for ([[maybe_unused]] const auto _ : state) {
    mesh::Delaunay delaunay;
    delaunay.build(generators);
    benchmark::DoNotOptimize(delaunay.triangles());
  }
  label(state, generators.size());
}
BENCHMARK(triangulation_from_scratch)->Arg(160)->Unit(benchmark::kMillisecond);

void whole_mesh(benchmark::State& state) {
  SheetPlan plan = plan_of(160, 150);
  plan.relaxation = state.range(0) ? Relaxation::quasi_newton : Relaxation::lloyd;
  double energy = 0;
  for ([[maybe_unused]] const auto _ : state) energy = tessellate(plan, MPI_COMM_SELF).energy_ratio;
  state.counters["energy_ratio"] = energy;
}
BENCHMARK(whole_mesh)->ArgName("quasi_newton")->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);

void sheet_from_cells(benchmark::State& state) {
  const Tessellation cells = tessellate(plan_of(160, 10), MPI_COMM_SELF);
  for ([[maybe_unused]] const auto _ : state)
    benchmark::DoNotOptimize(make_sheet(cells, {}).beams.size());
  label(state, cells.generators.size());
}
BENCHMARK(sheet_from_cells)->Unit(benchmark::kMillisecond);

}  // namespace

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  const Mpi mpi(argc, argv);
  const Session session(argv[0]);
  benchmark::RunSpecifiedBenchmarks();
}
