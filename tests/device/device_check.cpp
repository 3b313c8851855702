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
#include <vector>

#include "device/device_stepper.h"
#include "floe/session/session.h"
#include "support/dynamics.h"
#include "support/lattices.h"

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

/// A damped or undamped sheet under its weight and a load, held at one edge, pulled at the other.
struct Sheet {
  Scene scene;
  std::unique_ptr<test::Dynamics> run;
  device::DescribedModel described;
  double dt = 1e-4;

  Sheet(double bodies, double damping) {
    const double side = std::sqrt(bodies * std::sqrt(3.0) / 2);
    scene.forces.beam = scene.forces.gravity = true;
    scene.beam.damping_ratio = damping;
    Boundary left, right;
    left.name = left.set = "left", left.fixed.fill(true);
    right.name = right.set = "right", right.fixed = {true, false, false, false, true, false};
    right.velocity = Point3{0.05, 0, 0}, right.angular_velocity = {0, 0.01, 0};
    right.ramp.seconds = 0.01;
    scene.boundaries = {left, right};
    Load load;
    load.name = load.set = "all", load.force = {1e3, 2e3, -1e3}, load.ramp.seconds = 0.01;
    scene.loads = {load};
    SheetPlan plan;
    plan.length = plan.width = side, plan.element_size = 1, plan.iterations = 5;
    floe::Lattice lattice = make_sheet(tessellate(plan, MPI_COMM_SELF), SheetSection{});
    auto& all = lattice.sets["all"];
    for (std::int32_t b = 0; b < lattice.bodies.size(); ++b) all.push_back(b);
    run = std::make_unique<test::Dynamics>(scene, lattice);
    described = device::describe(run->model(), "cuda");
  }
  Sheet(const Sheet&) = delete;

  std::vector<double> records() const {
    std::vector<double> all;
    for (const std::int32_t b : described.order) {
      const double* from = run->state().record(static_cast<std::size_t>(b));
      all.insert(all.end(), from, from + Engine::record);
    }
    return all;
  }
  Steps steps(int first, int count) const {
    Steps s{count, dt, first == 0 ? 0.0 : dt, {}, {}};
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
    }
    return s;
  }
};

std::vector<double> stepped(Engine& engine, const Sheet& sheet, int count) {
  engine.put(0, sheet.records());
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

void compare(double bodies, double damping) {
  const Sheet sheet(bodies, damping);
  const std::string name = std::to_string(sheet.described.lattice.bodies) + " bodies, " +
                           (damping > 0 ? "damped" : "undamped");
  const auto loop = device::make_loop_engine({sheet.described.lattice});
  const auto exact = device::make_exact_cuda_engine({sheet.described.lattice});
  const auto fused = device::make_cuda_engine({sheet.described.lattice});
  const std::vector<double> a = stepped(*loop, sheet, 100), b = stepped(*exact, sheet, 100),
                            c = stepped(*fused, sheet, 100), d = stepped(*fused, sheet, 100);
  double differing = 0;
  for (std::size_t k = 0; k < a.size(); ++k) differing += a[k] == b[k] ? 0 : 1;
  say(name + ": numbers that differ from loop after 100 steps", differing == 0, "%.0f", differing);
  const device::Works works = exact->works(0), others = loop->works(0);
  const bool same =
      works.beams == others.beams && works.held == others.held && works.loaded == others.loaded;
  say(name + ": works like those of loop", same, "%.0f", same ? 1 : 0);
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

/// \param copies  of the sheet in one launch
void time_steps(double bodies, double damping, std::size_t copies, double allowed) {
  Sheet sheet(bodies, damping);
  const std::vector<Lattice> lattices(copies, sheet.described.lattice);
  const auto engine = device::make_cuda_engine(lattices);
  const std::vector<double> records = sheet.records();
  for (std::size_t r = 0; r < copies; ++r) engine->put(r, records);
  const std::vector<Steps> steps(copies, sheet.steps(50, 50));
  const double here = time_of(*engine, steps);
  sheet.run->set_step(sheet.dt);
  const double cpu = 1e6 * seconds_of([&] { sheet.run->steps(20); }) / 20;
  const auto all = static_cast<double>(copies);
  const std::string name = std::to_string(sheet.described.lattice.bodies) + " bodies x " +
                           std::to_string(copies) + (damping > 0 ? ", damped" : ", undamped");
  say(name + ": us per step", here <= allowed, "%.1f", here);
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
    compare(1460, damping);
    compare(20'000, damping);
  }
  compare_together();
  constexpr double anything = 1e9;
  for (const double damping : {0.0, 0.1}) {
    time_steps(1460, damping, 1, anything);
    time_steps(29'561, damping, 1, 10);
    time_steps(29'561, damping, 34, 300);
    time_steps(1460, damping, 50, anything);
  }
  std::printf(failures == 0 ? "all is well\n" : "%d things are not well\n", failures);
  return failures == 0 ? 0 : 1;
}
