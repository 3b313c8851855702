// ns per body of the water's forces on a slightly tilted floating sheet: buoyancy and drag, in
// still water and in waves.
#include <benchmark/benchmark.h>

#include "sheet.h"
#include "water/buoyancy.h"
#include "water/drag.h"

namespace {

using namespace floe;

void evaluate(benchmark::State& run, Force<Spatial>& force, bench::Sheet<Spatial>& c) {
  for ([[maybe_unused]] auto _ : run) {
    force.add(c.state, c.wrenches);
    benchmark::DoNotOptimize(c.wrenches.values.data());
  }
  run.counters["ns_per_body"] =
      benchmark::Counter(static_cast<double>(run.iterations()) * c.part.owned * 1e-9,
                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

void buoyancy(benchmark::State& run) {
  bench::Sheet<Spatial> c(run.range(0));
  evaluate(run, *make_buoyancy<Spatial>(c.part, 1010 * 9.81), c);
}
/// Bodies that the water cuts through their tops: no prism's closed form, polyhedra are clipped.
void buoyancy_clipped(benchmark::State& run) {
  bench::Sheet<Spatial> c(run.range(0));
  for (std::size_t b = 0; b < static_cast<std::size_t>(c.part.local); ++b)
    c.state.record(b)[2] = -0.5 * SheetSection{}.thickness;
  evaluate(run, *make_buoyancy<Spatial>(c.part, 1010 * 9.81), c);
}
void drag_linear(benchmark::State& run) {
  bench::Sheet<Spatial> c(run.range(0));
  evaluate(run, *make_drag<Spatial>(c.part, {.linear = 100}), c);
}
void drag_quadratic(benchmark::State& run) {
  bench::Sheet<Spatial> c(run.range(0));
  evaluate(run, *make_drag<Spatial>(c.part, {.coefficient = 1}), c);
}
/// Bodies of a sheet that moves; beams shelter its inner sides.
void drag_faces(benchmark::State& run) {
  bench::Sheet<Spatial> c(run.range(0));
  for (std::size_t b = 0; b < static_cast<std::size_t>(c.part.local); ++b)
    c.state.record(b)[Spatial::velocity] = 0.3;
  evaluate(run, *make_face_drag(c.part, {.faces = true, .form = 1.1, .skin = 0.003}, 9.81, {}), c);
}
void buoyancy_one_wave(benchmark::State& run) {
  bench::Sheet<Spatial> c(run.range(0));
  evaluate(run, *make_buoyancy_in_waves(c.part, 1010 * 9.81, 9.81, {.height = 0.1, .period = 30}),
           c);
}
void buoyancy_sea(benchmark::State& run) {
  bench::Sheet<Spatial> c(run.range(0));
  evaluate(run,
           *make_buoyancy_in_waves(
               c.part, 1010 * 9.81, 9.81,
               {.spectrum = WaveOptions::Spectrum::jonswap, .height = 0.1, .period = 60}),
           c);
}
/// Buoyancy and drag in steps, of bodies that the water cuts at their sides (third argument 0), or
/// through their tops. \param run  bodies, pace, whether through their tops
void in_steps(benchmark::State& run, const DragOptions& options) {
  bench::Sheet<Spatial> c(run.range(0));
  if (run.range(2) != 0)
    for (std::size_t b = 0; b < static_cast<std::size_t>(c.part.local); ++b)
      c.state.record(b)[2] = -0.5 * SheetSection{}.thickness;
  const auto submersion =
      std::make_shared<Submersion>(c.part, static_cast<int>(run.range(1)), true);
  const auto buoyancy = make_buoyancy(submersion, 1010 * 9.81);
  const auto drag =
      options.faces ? make_face_drag(submersion, options, false) : make_drag(submersion, options);
  for ([[maybe_unused]] auto _ : run) {
    submersion->before_evaluation(c.state);
    buoyancy->add(c.state, c.wrenches);
    drag->add(c.state, c.wrenches);
    submersion->after_evaluation();
    submersion->commit(c.state, 1);
    benchmark::DoNotOptimize(c.wrenches.values.data());
  }
  run.counters["ns_per_body"] =
      benchmark::Counter(static_cast<double>(run.iterations()) * c.part.owned * 1e-9,
                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}
void steps(benchmark::State& run) { in_steps(run, {.linear = 100, .coefficient = 1}); }
void steps_faces(benchmark::State& run) {
  in_steps(run, {.faces = true, .form = 1.1, .skin = 0.003});
}
BENCHMARK(steps)->ArgsProduct({{1460, 29561}, {1, 10}, {0, 1}});
BENCHMARK(steps_faces)->ArgsProduct({{1460}, {1, 10}, {0, 1}});
BENCHMARK(drag_faces)->Arg(1460);
BENCHMARK(buoyancy_one_wave)->Arg(1460);
BENCHMARK(buoyancy_sea)->Arg(1460);
BENCHMARK(buoyancy_clipped)->Arg(1460)->Arg(29561);
BENCHMARK(buoyancy)->Arg(1460)->Arg(29561);
BENCHMARK(drag_linear)->Arg(1460)->Arg(29561);
BENCHMARK(drag_quadratic)->Arg(1460)->Arg(29561);

}  // namespace

int main(int argc, char** argv) { return floe::bench::run(argc, argv); }
