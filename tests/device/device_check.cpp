// What needs a device: the bits of the back end loop, its numbers with fused operations, runs
// together, and times. Prints a table. Exit code 0: all is well, 1: something is not, 77: there is
// no device.
#include <petscsys.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "device/device_stepper.h"
#include "floe/session/session.h"
#include "support/contact_scene.h"
#include "support/dynamics.h"
#include "support/lattices.h"
#include "support/random.h"

namespace floe {
namespace {

using device::Engine;
using device::Lattice;
using device::Steps;

int failures = 0;

void say(const std::string& what, bool good, const char* format, double value) {
  std::printf("%-62s ", what.c_str());
  std::printf(format, value);
  std::printf("  %s\n", good ? "ok" : "NOT OK");
  std::fflush(stdout);
  failures += good ? 0 : 1;
}

/// A damped or undamped sheet under its weight and a load, held at one edge, pulled at the other;
/// or it floats in a current instead of being held. Its beams may break.
struct Sheet {
  Scene scene;
  std::unique_ptr<test::Dynamics> run;
  device::DescribedModel described;
  double dt = 1e-4;

  /// \param strength  of its beams [Pa]; 0: they do not break
  Sheet(double bodies, double damping, bool floats = false, int pace = 1, double strength = 0) {
    const double side = std::sqrt(bodies * std::sqrt(3.0) / 2);
    scene.forces.beam = scene.forces.gravity = true;
    scene.beam.damping_ratio = damping;
    scene.forces.fracture = strength > 0;
    scene.fracture.tensile_strength = scene.fracture.shear_strength = strength;
    scene.fracture.weibull_modulus = 3;
    Boundary left, right;
    left.name = left.set = "left", left.fixed.fill(true);
    right.name = right.set = "right", right.fixed = {true, false, false, false, true, false};
    right.velocity = Point3{0.05, 0, 0}, right.angular_velocity = {0, 0.01, 0};
    right.ramp.seconds = 0.01;
    if (!floats) scene.boundaries = {left, right};
    scene.forces.buoyancy = scene.forces.drag = floats;
    scene.drag.coefficient = 1;
    scene.drag.current = {0.3, 0.1, 0};
    scene.water_pace = pace;
    Load load;
    load.name = load.set = "all", load.force = {1e3, 2e3, -1e3}, load.ramp.seconds = 0.01;
    scene.loads = {load};
    SheetPlan plan;
    plan.length = plan.width = side, plan.element_size = 1, plan.iterations = 5;
    SheetSection section;
    if (floats) section.mid_plane = section.thickness * (0.5 - section.ice.density / 1010);
    floe::Lattice lattice = make_sheet(tessellate(plan, MPI_COMM_SELF), section);
    auto& all = lattice.sets["all"];
    for (std::int32_t b = 0; b < lattice.bodies.size(); ++b) all.push_back(b);
    run = std::make_unique<test::Dynamics>(scene, lattice);
    described = device::describe(run->model(), "cuda");
  }
  Sheet(Sheet&&) = default;

  /// The damage at the start: none.
  device::Damage damage() const {
    device::Damage none;
    if (described.numbers.breaking)
      described.numbers.breaking->kept->read(none.cracks, none.viscous);
    return none;
  }
  std::vector<double> records() const {
    std::vector<double> all;
    for (const std::int32_t b : described.order) {
      const double* from = run->state().record(static_cast<std::size_t>(b));
      all.insert(all.end(), from, from + Engine::record);
    }
    return all;
  }
  Steps steps(int first, int count) const {
    Steps s{.count = count, .dt = dt, .before = first == 0 ? 0.0 : dt};
    s.since = first % (described.numbers.water ? described.numbers.water->pace : 1);
    for (int n = first; n < first + count; ++n) {
      for (const double at : {n * dt, n * dt + dt}) {
        for (const PlacedBoundary& placed : run->model().boundaries()) {
          const auto values = placed.boundary.value(at);
          s.motions.insert(s.motions.end(), values.begin(), values.end());
        }
      }
      for (const DeviceModel::Load& load : described.numbers.loads) {
        const auto wrench = load.wrench(n * dt);
        s.wrenches.insert(s.wrenches.end(), wrench.begin(), wrench.end());
      }
      if (described.numbers.water) s.water.insert(s.water.end(), {0, 0.3, 0.1, 0});
      if (described.numbers.breaking) s.times.push_back(n * dt);
    }
    return s;
  }
};

std::vector<double> stepped(Engine& engine, const Sheet& sheet, int count) {
  engine.put(0, sheet.records());
  if (sheet.described.numbers.breaking) engine.put_damage(0, sheet.damage());
  for (int n = 0; n < count; n += 50) {
    const Steps steps = sheet.steps(n, std::min(50, count - n));
    engine.step({&steps, 1});
  }
  std::vector<double> records(sheet.records().size());
  engine.get(0, records);
  return records;
}

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double largest = 0, difference = 0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    largest = std::max(largest, std::abs(a[k]));
    difference = std::max(difference, std::abs(a[k] - b[k]));
  }
  return difference / largest;
}

std::string name_of(const Sheet& sheet) {
  const auto& water = sheet.described.lattice.water;
  return std::to_string(sheet.described.lattice.bodies) + " bodies, " +
         (sheet.described.lattice.damped ? "damped" : "undamped") +
         (sheet.described.lattice.breaking ? ", breaking" : "") +
         (water ? ", floating, pace " + std::to_string(water->pace) : "");
}

void compare(const Sheet& sheet) {
  const std::string name = name_of(sheet);
  const auto loop = device::make_loop_engine({sheet.described.lattice});
  const auto exact = device::make_exact_cuda_engine({sheet.described.lattice});
  const auto fused = device::make_cuda_engine({sheet.described.lattice});
  const std::vector<double> a = stepped(*loop, sheet, 100), b = stepped(*exact, sheet, 100),
                            c = stepped(*fused, sheet, 100), d = stepped(*fused, sheet, 100);
  double differing = 0;
  for (std::size_t k = 0; k < a.size(); ++k) differing += a[k] == b[k] ? 0 : 1;
  say(name + ": numbers that differ from loop after 100 steps", differing == 0, "%.0f", differing);
  const device::Works works = exact->works(0), others = loop->works(0);
  const bool same = works.beams == others.beams && works.held == others.held &&
                    works.loaded == others.loaded && works.drag == others.drag;
  say(name + ": works like those of loop", same, "%.0f", same ? 1 : 0);
  if (sheet.described.numbers.breaking) {
    const std::vector<double> cracks = loop->get_damage(0).cracks;
    double broken = 0;
    for (std::size_t m = device::Damage::damage; m < cracks.size(); m += device::Damage::numbers)
      broken += cracks[m] == 1 ? 1 : 0;
    say(name + ": broken beams", broken > 0, "%.0f", broken);
    const bool alike = exact->get_damage(0).cracks == cracks;
    say(name + ": damage like that of loop", alike, "%.0f", alike ? 1 : 0);
  }
  const double fusion = largest_difference(a, c);
  say(name + ": largest difference, fused", fusion < 1e-11, "%.1e", fusion);
  say(name + ": the same bits in a second run", c == d, "%.0f", c == d ? 1 : 0);
}

/// Runs of different sizes and dampings together and alone.
void compare_together() {
  std::vector<std::unique_ptr<Sheet>> sheets;
  std::vector<Lattice> lattices;
  for (const auto& [bodies, damping] : {std::pair{900.0, 0.1}, {1500.0, 0.0}, {400.0, 0.05}}) {
    sheets.push_back(std::make_unique<Sheet>(bodies, damping));
    lattices.push_back(sheets.back()->described.lattice);
    lattices.back().damped = true;  // as the others of the launch
  }
  const auto together = device::make_cuda_engine(lattices);
  std::vector<Steps> steps;
  for (std::size_t r = 0; r < sheets.size(); ++r) {
    together->put(r, sheets[r]->records());
    steps.push_back(sheets[r]->steps(0, 40 + 7 * static_cast<int>(r)));
  }
  together->step(steps);
  bool same = true;
  for (std::size_t r = 0; r < sheets.size(); ++r) {
    const auto alone = device::make_cuda_engine({lattices[r]});
    alone->put(0, sheets[r]->records());
    alone->step({&steps[r], 1});
    std::vector<double> a(sheets[r]->records().size()), b = a;
    together->get(r, a);
    alone->get(0, b);
    same = same && a == b;
  }
  say("three runs in one launch: the bits of each alone", same, "%.0f", same ? 1 : 0);
}

double seconds_of(const std::function<void()>& work) {
  const auto began = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
}

/// Median time of a step in microseconds, of launches of 50.
double time_of(Engine& engine, const std::vector<Steps>& steps) {
  std::vector<double> times;
  for (int repeat = 0; repeat < 12; ++repeat) {
    times.push_back(seconds_of([&] {
      engine.step(steps);
      (void)engine.findings(0);
    }));
  }
  std::sort(times.begin() + 2, times.end());  // the first two record the launches
  return 1e6 * times[7] / 50;
}

/// Blocks that fall in a heap on a floor.
struct Heap {
  Scene scene;
  floe::Lattice lattice;
  double dt = 2e-4;

  /// \param side  blocks along each edge
  explicit Heap(int side) {
    scene = test::contact_scene(5e6, 0.3, 0.4);
    test::Random random(3);
    for (int k = 0; k < side * side * side; ++k) {
      const Vec3<double> at{1.02 * (k % side), 1.02 * (k / side % side),
                            0.6 + 1.02 * (k / side / side)};
      test::append_block(lattice, {1, 1, 1}, at, random.rotation(0.05), random.vector(0.3));
    }
    test::append_obstacle(scene, "floor", half_space({0, 0, 0}, {0.1, 0, 1}));
  }
};
/// Records of the heap after some steps on an engine, and microseconds per step of the last ones.
std::pair<std::vector<double>, double> dropped(const Heap& heap, auto make, int steps) {
  test::Dynamics run(heap.scene, heap.lattice);
  run.set_step(heap.dt);
  device::DescribedModel described = device::describe(run.model(), "cuda");
  auto engine = make({described.lattice}, 0);
  device::DeviceStepper stepper(run.model(), std::move(described), std::move(engine));
  const WorkLedger ledger(run.model());
  stepper.put(run.state(), ledger.all());
  double last = 0;
  for (int n = 0; n < steps; n += 50) {
    last = seconds_of([&] {
      for (int k = 0; k < 50; ++k)
        stepper.queue((n + k) * heap.dt, heap.dt, n + k == 0 ? 0.0 : heap.dt);
      (void)stepper.flush();
    });
  }
  stepper.get(run.state());
  return {run.state().records, 1e6 * last / 50};
}

/// Contacts: bits and numbers as compare() has them.
void compare_contacts(int side, int steps) {
  const Heap heap(side);
  const auto [loop, slow] = dropped(heap, device::make_loop_engine, steps);
  const auto [exact, not_fused] = dropped(heap, device::make_exact_cuda_engine, steps);
  const auto [fused, fast] = dropped(heap, device::make_cuda_engine, steps);
  const std::string name = std::to_string(heap.lattice.bodies.size()) + " blocks in contact";
  std::size_t other = 0;
  for (std::size_t k = 0; k < loop.size(); ++k) other += loop[k] == exact[k] ? 0 : 1;
  say(name + ": numbers with other bits than loop", other == 0, "%.0f", static_cast<double>(other));
  say(name + ": fused operations against loop", largest_difference(loop, fused) < 1e-6, "%.1e",
      largest_difference(loop, fused));
  say(name + ": us per step, lists included", true, "%.1f", fast);
}

/// \param copies  of the sheet in one launch
void time_steps(Sheet sheet, std::size_t copies, double allowed) {
  const std::vector<Lattice> lattices(copies, sheet.described.lattice);
  const auto engine = device::make_cuda_engine(lattices);
  const std::vector<double> records = sheet.records();
  for (std::size_t r = 0; r < copies; ++r) engine->put(r, records);
  const std::vector<Steps> steps(copies, sheet.steps(50, 50));
  const double here = time_of(*engine, steps);
  sheet.run->set_step(sheet.dt);
  const double cpu = 1e6 * seconds_of([&] { sheet.run->steps(20); }) / 20;
  const auto all = static_cast<double>(copies);
  say(std::to_string(copies) + " x " + name_of(sheet) + ": us per step", here <= allowed, "%.1f",
      here);
  std::printf("%62s one core of the processor: %.0f us, %.0f times that\n", "", all * cpu,
              all * cpu / here);
}

}  // namespace
}  // namespace floe

int main(int argc, char** argv) {
  using namespace floe;
  const std::string device = device::name_of_device();
  if (device.empty()) {
    std::puts("device_check: no device: skipped");
    return 77;
  }
  std::printf("device: %s\n", device.c_str());
  const Mpi mpi(argc, argv);
  const Session session(argv[0]);
  for (const double damping : {0.0, 0.1}) {
    compare(Sheet(1460, damping));
    compare(Sheet(20'000, damping));
  }
  compare(Sheet(1460, 0.1, true));
  compare(Sheet(1460, 0.1, true, 10));
  compare(Sheet(1460, 0.1, false, 1, 3e5));
  compare(Sheet(1460, 0, false, 1, 3e5));
  compare_together();
  compare_contacts(4, 500);
  compare_contacts(12, 500);
  constexpr double anything = 1e9;
  for (const double damping : {0.0, 0.1}) {
    time_steps(Sheet(1460, damping), 1, anything);
    time_steps(Sheet(29'561, damping), 1, 10);
    time_steps(Sheet(29'561, damping), 34, 300);
    time_steps(Sheet(1460, damping), 50, anything);
  }
  constexpr double holds = 1e9;
  for (const double damping : {0.0, 0.1}) {
    time_steps(Sheet(29'561, damping, false, 1, holds), 1, anything);
    time_steps(Sheet(29'561, damping, false, 1, holds), 34, anything);
  }
  for (const int pace : {1, 10}) {
    time_steps(Sheet(29'561, 0.1, true, pace), 1, anything);
    time_steps(Sheet(29'561, 0.1, true, pace), 34, anything);
  }
  std::printf(failures == 0 ? "all is well\n" : "%d things are not well\n", failures);
  return failures == 0 ? 0 : 1;
}
