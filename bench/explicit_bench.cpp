// One explicit step and what it is made of, ns per beam: build/release/bench/explicit_bench.
//   step      forces, update of the bodies, nothing else; `breakable`: beams with strengths,
//             intact; `broken`: all of them broken; `planar`: bodies and beams of a planar model
//   zero      wrenches set to zero
//   gather    records of the beams' bodies into lanes
//   kernel    arithmetic of a beam on one block that stays in the nearest cache: the floor
//   scatter   shares added to the bodies' wrenches
//   beams     the three together, as they run
//   bodies    leapfrog of the bodies
//   ts        what PETSc's TS adds to a step, in ns per step
#include <benchmark/benchmark.h>

#include <cmath>
#include <map>
#include <tuple>

#include "beams/lanes.h"
#include "beams/spatial.h"
#include "explicit/leapfrog.h"
#include "leapfrog/planar_leapfrog_stepper.h"
#include "model/model.h"
#include "sheet.h"

namespace {

using namespace floe;
using Blocks = std::vector<BeamBlock<FlatFrame>>;

/// A meshed sheet of about `bodies` bodies with a smooth motion.
template <class Space>
class Case {
 public:
  Case(std::int64_t bodies, double damping, bool breakable)
      : lattice_(mesh(bodies)),
        model(lattice_, PETSC_COMM_SELF, {}),
        motion(start(damping, breakable)) {
    lattice_ = {};
  }
  static Case& of(std::int64_t bodies, double damping, bool breakable = false) {
    // Never destroyed: PETSc ends before statics do.
    static auto& cases =
        *new std::map<std::tuple<std::int64_t, double, bool>, std::unique_ptr<Case>>;
    auto& found = cases[{bodies, damping, breakable}];
    if (!found) found = std::make_unique<Case>(bodies, damping, breakable);
    return *found;
  }
  /// Sets the counter that tools/bench prints.
  void count(benchmark::State& bench) const {
    bench.counters["ns_per_beam"] = benchmark::Counter(
        static_cast<double>(model.part().beams.size()) * 1e-9,
        benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
  }
  void step() {
    model.evaluate(state, wrenches);
    benchmark::DoNotOptimize(motion.step(state, wrenches, dt));
    for (const auto& force : model.forces()) {
      if (auto* role = force->roles().commits) role->commit(state, dt);
    }
  }

  /// Pulls all bodies apart once, so that all beams break.
  void break_beams() {
    const State<Space> before = state;
    const Part& part = model.part();
    for (std::size_t b = 0; b < static_cast<std::size_t>(part.local); ++b) {
      for (std::size_t k = 0; k < 2; ++k) state.record(b)[k] += part.bodies.position[b][k];
    }
    step();
    state = before;
  }

  static constexpr double dt = 1e-5;

 private:
  static Lattice mesh(std::int64_t bodies) {
    SheetSection section;
    section.thickness = 0.5;
    return bench::meshed_sheet(bodies, section);
  }
  LeapfrogStepperOf<Space> start(double damping, bool breakable) {
    BeamOptions options;
    options.damping_ratio = damping;
    model.set_beams(beams_of(options, breakable), Kinematics::corotational);
    const Part& part = model.part();
    const auto local = static_cast<std::size_t>(part.local);
    state = State<Space>(local);
    wrenches = Wrenches<Space>(local);
    std::vector<Point3> velocity(local), spin(local);
    for (std::size_t b = 0; b < local; ++b) {
      const Point3& x = part.bodies.position[b];
      for (std::size_t k = 0; k < 3; ++k) {
        velocity[b][k] = 1e-3 * std::sin(0.1 * x[0] + static_cast<double>(k));
        spin[b][k] = 1e-4 * std::cos(0.1 * x[1] - static_cast<double>(k));
      }
    }
    LeapfrogStepperOf<Space> made(model);
    made.start(state, velocity, spin);
    return made;
  }
  std::unique_ptr<BeamForce<Space>> beams_of(const BeamOptions& options, bool breakable) {
    if constexpr (std::is_same_v<Space, Spatial>) {
      if (breakable) return make_breakable_beams(model.part(), options, strong()).force;
    }
    return make_beam_force<Space>(model.part(), options);
  }

  /// Strengths that nothing here reaches: an intact sheet.
  static FractureOptions strong() {
    FractureOptions options;
    options.tensile_strength = options.shear_strength = 1e9;
    return options;
  }

  Lattice lattice_;

 public:
  Model<Space> model;
  State<Space> state;
  Wrenches<Space> wrenches;
  LeapfrogStepperOf<Space> motion;
};
using InSpace = Case<Spatial>;

/// A case's beams once more, for parts of what the force does with them.
const Blocks& blocks_of(const InSpace& c) {
  static std::map<const InSpace*, Blocks> all;
  Blocks& blocks = all[&c];
  if (!blocks.empty()) return blocks;
  const Part& part = c.model.part();
  blocks.resize((part.beams.bodies.size() + lanes - 1) / lanes);
  for (std::int32_t m = 0; m < part.beams.size(); ++m) {
    const auto k = static_cast<std::size_t>(m);
    BeamBlock<FlatFrame>& block = blocks[k / lanes];
    block.set(k % lanes, SpatialBeam<Kinematics::corotational>::make(part, m, Shear::one_point));
    block.i[k % lanes] = part.beams.bodies[k][0];
    block.j[k % lanes] = part.beams.bodies[k][1];
  }
  return blocks;
}

template <class Space>
void step_in(benchmark::State& bench, double damping, bool breakable) {
  auto& c = Case<Space>::of(bench.range(0), damping, breakable);
  for ([[maybe_unused]] auto _ : bench) c.step();
  c.count(bench);
}
void step(benchmark::State& bench, double damping, bool breakable) {
  step_in<Spatial>(bench, damping, breakable);
}
void broken_step(benchmark::State& bench, double damping) {
  InSpace c(bench.range(0), damping, true);
  c.break_beams();
  for ([[maybe_unused]] auto _ : bench) c.step();
  c.count(bench);
}
void planar_step(benchmark::State& bench, double damping) {
  step_in<Planar>(bench, damping, false);
}

void zero(benchmark::State& bench) {
  InSpace& c = InSpace::of(bench.range(0), 0);
  for ([[maybe_unused]] auto _ : bench) {
    std::fill(c.wrenches.values.begin(), c.wrenches.values.end(), 0.0);
    benchmark::ClobberMemory();
  }
  c.count(bench);
}

[[gnu::flatten]] void gather_all(const InSpace& c) {
  Lanes sum(0.0);
  for (const BeamBlock<FlatFrame>& block : blocks_of(c)) {
    for (const auto* bodies : {&block.i, &block.j}) {
      const LaneBodies b = gather<false>(c.state.records.data(), *bodies);
      sum += (b.u.x + b.u.y + b.u.z) + (b.q.w + b.q.x + b.q.y + b.q.z);
    }
  }
  benchmark::DoNotOptimize(reduce(sum));
}
void gather(benchmark::State& bench) {
  const InSpace& c = InSpace::of(bench.range(0), 0);
  for ([[maybe_unused]] auto _ : bench) gather_all(c);
  c.count(bench);
}

[[gnu::flatten]] void compute_all(const InSpace& c) {
  using Kernel = BeamKernel<Kinematics::corotational>;
  BeamBlock<FlatFrame> block = blocks_of(c).front();
  const LaneBodies i = floe::gather<false>(c.state.records.data(), block.i),
                   j = floe::gather<false>(c.state.records.data(), block.j);
  Lanes sum(0.0);
  const std::size_t count = blocks_of(c).size();
  for (std::size_t k = 0; k < count; ++k) {
    __asm__ volatile("" : : "r"(&block), "r"(&i), "r"(&j) : "memory");
    const BeamConstants<Lanes, FlatFrame> beam = block.get();
    const BeamGradient<Lanes> g =
        Kernel::gradient(beam, Kernel::strains(beam, j.u - i.u, i.q, j.q));
    sum += (g.force.x + g.force.y + g.force.z) + (g.moment_i.x + g.moment_i.y + g.moment_i.z) +
           (g.moment_j.x + g.moment_j.y + g.moment_j.z);
  }
  benchmark::DoNotOptimize(reduce(sum));
}
void kernel(benchmark::State& bench) {
  const InSpace& c = InSpace::of(bench.range(0), 0);
  for ([[maybe_unused]] auto _ : bench) compute_all(c);
  c.count(bench);
}

[[gnu::flatten]] void scatter_all(InSpace& c) {
  const Lanes one(1e-3);
  const BeamGradient<Lanes> g{{one, one, one}, {one, one, one}, {one, one, one}};
  for (const BeamBlock<FlatFrame>& block : blocks_of(c))
    floe::scatter(block.i, block.j, g, c.wrenches.values.data());
}
void scatter(benchmark::State& bench) {
  InSpace& c = InSpace::of(bench.range(0), 0);
  for ([[maybe_unused]] auto _ : bench) scatter_all(c);
  c.count(bench);
}

void beams(benchmark::State& bench, double damping) {
  InSpace& c = InSpace::of(bench.range(0), damping);
  for ([[maybe_unused]] auto _ : bench) {
    c.model.forces().front()->add(c.state, c.wrenches);
    benchmark::ClobberMemory();
  }
  c.count(bench);
}

void bodies(benchmark::State& bench) {
  InSpace& c = InSpace::of(bench.range(0), 0);
  std::fill(c.wrenches.values.begin(), c.wrenches.values.end(), 0.0);
  for ([[maybe_unused]] auto _ : bench)
    benchmark::DoNotOptimize(c.motion.step(c.state, c.wrenches, 1e-9));
  c.count(bench);
}

/// A TS whose steps do nothing.
void ts(benchmark::State& bench) {
  register_leapfrog();
  constexpr PetscInt steps = 10000;
  Handle<Vec> solution;
  check(VecCreateSeq(PETSC_COMM_SELF, 16, solution.put()));
  LeapfrogStep nothing = [](double) { return true; };
  for ([[maybe_unused]] auto _ : bench) {
    Handle<TS> stepper;
    check(TSCreate(PETSC_COMM_SELF, stepper.put()));
    check(TSSetType(stepper, ts_leapfrog));
    check(TSSetSolution(stepper, solution));
    check(TSSetTimeStep(stepper, 1.0));
    check(TSSetMaxSteps(stepper, steps));
    check(TSSetMaxTime(stepper, 1e9));
    check(TSSetExactFinalTime(stepper, TS_EXACTFINALTIME_STEPOVER));
    set_leapfrog_step(stepper, &nothing);
    check(TSSolve(stepper, nullptr));
  }
  bench.counters["ns_per_step"] = benchmark::Counter(
      static_cast<double>(steps) * 1e-9,
      benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void sizes(benchmark::internal::Benchmark* bench) {
  bench->Arg(1460)->Arg(29561)->Arg(1000000)->Unit(benchmark::kMicrosecond);
}
BENCHMARK_CAPTURE(step, undamped, 0.0, false)->Apply(sizes);
BENCHMARK_CAPTURE(step, damped, 1.0, false)->Apply(sizes);
BENCHMARK_CAPTURE(planar_step, undamped, 0.0)->Apply(sizes);
BENCHMARK_CAPTURE(planar_step, damped, 1.0)->Apply(sizes);
BENCHMARK_CAPTURE(step, breakable_undamped, 0.0, true)->Apply(sizes);
BENCHMARK_CAPTURE(step, breakable_damped, 1.0, true)->Apply(sizes);
BENCHMARK_CAPTURE(broken_step, undamped, 0.0)->Apply(sizes);
BENCHMARK_CAPTURE(broken_step, damped, 1.0)->Apply(sizes);
BENCHMARK_CAPTURE(beams, undamped, 0.0)->Apply(sizes);
BENCHMARK_CAPTURE(beams, damped, 1.0)->Apply(sizes);
BENCHMARK(gather)->Apply(sizes);
BENCHMARK(kernel)->Apply(sizes);
BENCHMARK(scatter)->Apply(sizes);
BENCHMARK(bodies)->Apply(sizes);
BENCHMARK(zero)->Apply(sizes);
BENCHMARK(ts)->Unit(benchmark::kMicrosecond);

}  // namespace

int main(int argc, char** argv) { return floe::bench::run(argc, argv); }
