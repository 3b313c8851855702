// The text of devices, in loops on the processor: its steps are those of the lanes, whatever its
// tiles, and several runs in one engine are each what they are alone.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numeric>
#include <string>
#include <vector>

#include "device/device_stepper.h"
#include "device/tiles.h"
#include "floe/base/item.h"
#include "forces/support.h"
#include "support/alike.h"
#include "support/dynamics.h"
#include "support/lattices.h"
#include "support/random.h"
#include "support/scene_options.h"
#include "support/states.h"

namespace floe {
namespace {

using device::DeviceStepper;
using device::Engine;
using test::Dynamics;

/// Records of all bodies, works of the forces and of boundaries, largest speed and spin.
struct Stepped {
  State<Spatial> state;
  std::vector<double> works;
  double boundary = 0, speed2 = 0, fastest_spin = 0;
  // Of beams that break:
  std::vector<double> damage;  ///< per beam
  std::vector<Break> breaks;   ///< in the order of the beams
  double dissipated = 0;       ///< [J]
};
/// Notes the cracks of committed steps.
void note_cracks(Dynamics& run, std::span<const double> works, Stepped& out) {
  const Fracture* fracture = run.model().fracture();
  if (fracture == nullptr) return;
  for (std::int32_t m = 0; m < run.model().part().beams.size(); ++m)
    out.damage.push_back(fracture->damage(m));
  out.breaks = fracture->breaks();
  std::sort(out.breaks.begin(), out.breaks.end(),
            [](const Break& a, const Break& b) { return a.beam < b.beam; });
  for (const auto& [column, value] : run.model().report(run.state(), works))
    if (column == "energy_fracture") out.dissipated = value;
}

/// A scene, its lattice, and its motion at the start.
struct Case {
  Scene scene;
  Lattice lattice;
  double size = 0, turn = 0, speed = 0;  ///< of random displacements, rotations, velocities
  double dt = 1e-3;
  std::vector<Support> supports{};  ///< beside the forces of the scene
};

/// The scene with its motion half a step before the first step.
std::unique_ptr<Dynamics> at_start(const Case& of) {
  Lattice lattice = of.lattice;
  test::Random random(5);
  for (std::size_t b = 0; b < lattice.bodies.mass.size(); ++b) {
    lattice.bodies.velocity.push_back(random.vector(of.speed));
    lattice.bodies.angular_velocity.push_back(random.vector(of.speed));
  }
  auto made =
      std::make_unique<Dynamics>(of.scene, lattice, PETSC_COMM_SELF, [&](Model<Spatial>& model) {
        if (!of.supports.empty()) model.add_force(make_supports(model.part(), of.supports));
      });
  const State<Spatial> from = test::deformed(made->model().part(), of.size, of.turn);
  for (std::size_t b = 0; b < lattice.bodies.mass.size(); ++b) {
    std::copy_n(from.record(b), Spatial::velocity, made->state().record(b));
    // The angular momentum belongs to the rotation.
    double* r = made->state().record(b);
    const Vec3<double> w = angular_velocity(made->state(), b);
    const auto [q0, q1, q2, q3] = lattice.bodies.orientation[b];
    const Triad<double> axes =
        triad(product(rotation(made->state(), b), Quat<double>{q0, q1, q2, q3}));
    const Vec3<double> l = axes.to_local(w);
    const Point3& inertia = lattice.bodies.inertia[b];
    const Vec3<double> momentum =
        axes.to_world({inertia.x * l.x, inertia.y * l.y, inertia.z * l.z});
    r[Spatial::angular_momentum] = momentum.x;
    r[Spatial::angular_momentum + 1] = momentum.y;
    r[Spatial::angular_momentum + 2] = momentum.z;
  }
  made->evaluate();
  made->set_step(of.dt);
  return made;
}

Stepped by_lanes(const Case& of, int steps) {
  const auto run = at_start(of);
  Stepped out;
  for (int n = 0; n < steps; ++n) {
    (void)(n + 1 < steps ? run->step() : run->step_without_evaluation());
    // Not the stepper's own, which counts held bodies as if they were free.
    for (std::size_t b = 0; b < of.lattice.bodies.mass.size(); ++b) {
      const Vec3<double> v = velocity(run->state(), b), w = angular_velocity(run->state(), b);
      out.speed2 = std::max(out.speed2, dot(v, v));
      out.fastest_spin = std::max(out.fastest_spin, std::sqrt(dot(w, w)));
    }
  }
  out.state = run->state();
  out.boundary = run->boundary_work();
  out.works = run->works();
  note_cracks(*run, out.works, out);
  return out;
}

/// \param queued  steps that are made at once
/// \param halts  a break halts the run within a launch
Stepped by_loop(const Case& of, int steps, std::int32_t tile = 0, int queued = 7,
                bool halts = false) {
  const auto run = at_start(of);
  device::DescribedModel described = device::describe(run->model(), "loop");
  described.lattice.halts_at_breaks = halts;
  auto engine = device::make_loop_engine({described.lattice}, tile);
  DeviceStepper stepper(run->model(), std::move(described), std::move(engine));
  WorkLedger ledger(run->model());
  stepper.put(run->state(), {{ledger.all().begin(), ledger.all().end()}, 0, {}});
  Stepped out;
  double before = 0;
  const auto flush = [&] {
    (void)stepper.take_works(ledger.all());  // looks change nothing
    out.speed2 = std::max(out.speed2, stepper.flush());
    out.fastest_spin = std::max(out.fastest_spin, stepper.fastest_spin());
  };
  for (int n = 0; n < steps; ++n) {
    stepper.queue(n * of.dt, of.dt, before);
    before = of.dt;
    if ((n + 1) % queued == 0) flush();
  }
  flush();
  stepper.get(run->state());
  out.state = run->state();
  out.boundary = stepper.take_works(ledger.all());
  out.works.assign(ledger.all().begin(), ledger.all().end());
  note_cracks(*run, out.works, out);
  return out;
}

void expect_alike(const Stepped& a, const Stepped& b, double tolerance) {
  test::expect_alike(a.state, b.state, tolerance);
  EXPECT_NEAR(std::sqrt(a.speed2), std::sqrt(b.speed2), tolerance * std::sqrt(a.speed2));
  EXPECT_NEAR(a.fastest_spin, b.fastest_spin, tolerance * a.fastest_spin);
}

Load dead(const std::string& set, const Point3& force, const Point3& moment, double ramp) {
  Load load;
  load.name = set;
  load.set = set;
  load.force = force, load.moment = moment;
  load.ramp.seconds = ramp;
  return load;
}

/// A damped sheet that hangs from its left edge, bent, with loads at points and on sets, whose
/// right edge moves on.
Case sheet_case(double damping = 0.1) {
  Case c;
  c.lattice = test::sheet(12, 8, 1);
  c.scene.forces.beam = c.scene.forces.gravity = true;
  c.scene.beam.damping_ratio = damping;
  c.scene.loads = {dead("all", {3e3, -2e3, 1e3}, {50, -20, 80}, 0.03)};
  Load point = dead("", {0, 500, -4e3}, {}, 0);
  point.name = "point", point.point = {6.2, 4.3};
  c.scene.loads.push_back(point);
  Boundary left, right;
  left.name = left.set = "left", left.fixed = {true, true, true, false, false, false};
  right.name = right.set = "right", right.fixed = {true, false, false, false, true, false};
  right.velocity = Point3{0.2, 0, 0}, right.angular_velocity = {0, 0.4, 0};
  right.ramp.seconds = 0.02;
  c.scene.boundaries = {left, right};
  c.size = 1e-3, c.turn = 0.01, c.speed = 0.3;
  c.dt = 2e-4;
  return c;
}

/// A frame in space, bent by more than the series of the kernel take, that tumbles.
Case frame_case() {
  Case c;
  c.lattice =
      test::frame({{0, 0, 0}, {1, 0.2, 0.1}, {1.7, 0.9, -0.3}, {2.5, 0.4, 0.6}, {0.3, 1, 1}},
                  {{0, 1}, {1, 2}, {2, 3}, {0, 4}, {1, 4}, {2, 4}});
  for (auto& orientation : c.lattice.bodies.orientation) {
    const Quat<double> q = exp_rotation({0.3, -0.5, 0.9});
    orientation = {q.w, q.x, q.y, q.z};
  }
  c.scene = test::beams_only(Shear::exact, 0.05);
  Boundary turned;
  turned.name = "turned", turned.set = "last", turned.fixed.fill(true);
  turned.angular_velocity = {0.5, -0.2, 0.3}, turned.velocity = Point3{0.1, 0.2, -0.1};
  turned.ramp.seconds = 0.05;
  c.scene.boundaries = {turned};
  c.size = 0.2, c.turn = 0.5, c.speed = 2;
  c.dt = 2e-3;
  return c;
}

Case eccentric_case() {
  Case c = frame_case();
  test::Random random(7);
  std::vector<Point3> moves;
  for (std::size_t b = 0; b < c.lattice.bodies.mass.size(); ++b) {
    moves.push_back(random.vector(0.2));
    c.lattice.bodies.position[b] = c.lattice.bodies.position[b] + moves[b];
  }
  for (const auto& [i, j] : c.lattice.beams.bodies)
    c.lattice.beams.offsets.push_back({-item(moves, i), -item(moves, j)});
  return c;
}

/// A floating sheet, damped by the water, whose bodies have moved so far that the water cuts some
/// of them across; some are wet or dry.
Case floating_case(int pace = 1, bool quadratic = true, bool level_moves = false) {
  Case c;
  c.lattice = test::sheet(12, 8, 1, true);
  c.scene.forces.beam = c.scene.forces.gravity = c.scene.forces.buoyancy = c.scene.forces.drag =
      true;
  c.scene.beam.damping_ratio = 0.05;
  c.scene.water_pace = pace;
  c.scene.drag.linear = 150;
  c.scene.drag.coefficient = quadratic ? 1.2 : 0;
  c.scene.drag.current = {0.4, -0.3, 0.1};
  if (level_moves)
    c.scene.drag.level_table =
        TimeTable({{0, 0}, {1, 0.3}}, TimeTable::Interpolation::linear, false);
  c.size = pace > 1 ? 0.02 : 0.3, c.turn = pace > 1 ? 0.05 : 0.6, c.speed = 0.5;
  c.dt = 1e-4;
  return c;
}

/// A sheet that breaks: some of its beams soften, some break at once, others hold. Its right edge
/// goes away and turns down; a load pushes others together.
Case breaking_case(double damping = 0.1, double energy = 200, double compressive = 0) {
  Case c = sheet_case(damping);
  c.scene.forces.fracture = true;
  c.scene.fracture.tensile_strength = 4e5, c.scene.fracture.shear_strength = 3e5;
  c.scene.fracture.energy = energy, c.scene.fracture.energy_shear = 0.5 * energy;
  c.scene.fracture.weibull_modulus = 4;
  c.scene.fracture.compressive_strength = compressive;
  if (compressive > 0) c.scene.fracture.bending_factor = 0.7;
  return c;
}

/// The same of a frame in space with eccentric beams.
Case breaking_frame_case() {
  Case c = eccentric_case();
  c.scene.forces.fracture = true;
  c.scene.fracture.tensile_strength = 100, c.scene.fracture.shear_strength = 60;
  c.scene.fracture.energy = c.scene.fracture.energy_shear = 20;
  const std::size_t beams = c.lattice.beams.bodies.size();
  c.lattice.beams.width.assign(beams, 0.3);
  c.lattice.beams.height.assign(beams, 0.2);
  return c;
}

/// The frame with springs and dashpots on a body, off its centroid.
Case supported_case() {
  Case c = frame_case();
  test::Random random(3);
  Support support{.name = "structure", .body = 2, .point = {2, 1, -0.1}};
  for (std::size_t r = 0; r < 6; ++r) {
    for (std::size_t k = 0; k <= r; ++k) {
      const double coupling = random.uniform(-3, 3), loss = random.uniform(-0.3, 0.3);
      support.stiffness[6 * r + k] = support.stiffness[6 * k + r] = r == k ? 40 : coupling;
      support.damping[6 * r + k] = support.damping[6 * k + r] = r == k ? 3 : loss;
    }
  }
  c.supports = {support};
  return c;
}

// Forces to rounding: by the velocities that they give in a step.
TEST(Device, AStepIsThatOfTheLanes) {
  for (const Case& c :
       {sheet_case(), sheet_case(0), frame_case(), eccentric_case(), supported_case(),
        floating_case(), floating_case(4, false), floating_case(1, true, true)})
    expect_alike(by_lanes(c, 1), by_loop(c, 1), 1e-15);
}

TEST(Device, AHundredStepsAreThoseOfTheLanes) {
  for (const Case& c :
       {sheet_case(), sheet_case(0), frame_case(), eccentric_case(), supported_case()}) {
    const Stepped lanes = by_lanes(c, 100), loop = by_loop(c, 100);
    expect_alike(lanes, loop, 1e-11);
    EXPECT_GT(std::abs(lanes.boundary), 0);
    EXPECT_NEAR(loop.boundary, lanes.boundary, 1e-11 * std::abs(lanes.boundary));
  }
}

// Bodies that the water cuts in all ways; submerged parts that are followed between the steps that
// find them; the water's level and current move.
TEST(Device, FloatsAsWithTheLanes) {
  for (const Case& c : {floating_case(), floating_case(4), floating_case(3, false),
                        floating_case(1, true, true), floating_case(5, true, true)}) {
    expect_alike(by_lanes(c, 100), by_loop(c, 100), 1e-11);
    Case still = c;
    still.scene.forces.drag = false;
    expect_alike(by_lanes(still, 10), by_loop(still, 10), 1e-13);
    EXPECT_GT(
        test::difference(by_lanes(still, 10).state, by_lanes(c, 10).state, Spatial::velocity, 3),
        1e-6);
  }
}

void expect_same_cracks(const Stepped& a, const Stepped& b, double tolerance) {
  ASSERT_EQ(a.breaks.size(), b.breaks.size());
  for (std::size_t k = 0; k < a.breaks.size(); ++k) {
    const Break &one = a.breaks[k], &other = b.breaks[k];
    EXPECT_EQ(one.beam, other.beam);
    EXPECT_NEAR(one.time, other.time, 1e-12);
    EXPECT_EQ(one.brittle, other.brittle);
    EXPECT_NEAR(one.mode_mix, other.mode_mix, tolerance);
    EXPECT_NEAR(one.nominal, other.nominal, tolerance * one.nominal);
    EXPECT_NEAR(one.energy, other.energy, tolerance * one.nominal);
    for (std::size_t n = 0; n < 3; ++n) EXPECT_NEAR(one.place[n], other.place[n], tolerance);
  }
  for (std::size_t m = 0; m < a.damage.size(); ++m)
    EXPECT_NEAR(a.damage[m], b.damage[m], tolerance) << m;
  EXPECT_NEAR(a.dissipated, b.dissipated, tolerance * a.dissipated);
}

// Beams soften, break gradually, at once and under pressure; bits do not depend on tiles, queues,
// or halts at breaks.
TEST(Device, BreaksAsWithTheLanes) {
  std::array<int, 4> seen{};  // softened, broken, brittle, of another mode
  for (const Case& c : {breaking_case(), breaking_case(0), breaking_case(0.1, 15),
                        breaking_case(0.1, 200, 1e6), breaking_frame_case()}) {
    for (const int steps : {1, 60}) {
      const Stepped lanes = by_lanes(c, steps), loop = by_loop(c, steps);
      expect_alike(lanes, loop, steps == 1 ? 1e-15 : 1e-11);
      expect_same_cracks(lanes, loop, 1e-10);
      for (const double damage : lanes.damage) seen[0] += damage > 0 && damage < 1 ? 1 : 0;
      for (const Break& b : lanes.breaks) {
        ++seen[1];
        seen[2] += b.brittle ? 1 : 0;
        seen[3] += b.mode_mix > 0.2 && b.mode_mix < 0.8 ? 1 : 0;
      }
    }
    const Stepped one = by_loop(c, 60, 32);
    EXPECT_GT(one.breaks.size(), 0U);
    for (const std::int32_t tile : {3, 128}) {
      for (const bool halts : {false, true}) {
        const Stepped other = by_loop(c, 60, tile, 20, halts);
        EXPECT_EQ(one.state.records, other.state.records);
        EXPECT_EQ(one.works, other.works);
        EXPECT_EQ(one.damage, other.damage);
        EXPECT_EQ(one.speed2, other.speed2);
      }
    }
  }
  for (const int count : seen) EXPECT_GT(count, 5);
}

// What the evaluation after the last step would add is not in them: by the rules of LeapfrogWork
// that is dt/2 of the power of loads, 3/4 dt of that of dashpots, and dt/2 of both powers of the
// dashpots of beams that break.
TEST(Device, WorksAreThoseOfTheLanes) {
  int compared = 0;
  for (const Case& c :
       {sheet_case(), breaking_case(), supported_case(), floating_case(4, true, true)}) {
    const auto run = at_start(c);
    run->steps(40);
    const Stepped loop = by_loop(c, 40);
    const std::vector<double> works = run->works();
    std::size_t first = 0;
    for (const auto& force : run->model().forces()) {
      const DoesWork<Spatial>* role = force->roles().work;
      if (role == nullptr) continue;
      double power = 0, kept = 0;
      role->powers({&power, 1});
      const LaterPowers later = role->later_powers();
      if (later == LaterPowers::in_next_evaluation) role->kept_powers({&kept, 1}), power += kept;
      const double part = later == LaterPowers::never ? 0.75 : 0.5;
      EXPECT_NEAR(loop.works[first], works[first] - part * c.dt * power,
                  1e-11 * std::abs(works[first]))
          << force->name();
      EXPECT_NE(loop.works[first], 0) << force->name();
      first += role->works();
      ++compared;
    }
  }
  // Twice beams and two loads; beams and a support; beams, buoyancy and drag.
  EXPECT_EQ(compared, 11);
}

TEST(Device, TilesAndQueuesChangeNoBit) {
  const Case c = sheet_case();
  const Stepped one = by_loop(c, 20, 32);
  for (const std::int32_t tile : {1, 3, 64, 128}) {
    for (const int queued : {1, 2, 20}) {
      const Stepped other = by_loop(c, 20, tile, queued);
      EXPECT_EQ(one.state.records, other.state.records) << tile << " " << queued;
      EXPECT_EQ(one.works, other.works);
      EXPECT_EQ(one.boundary, other.boundary);
      EXPECT_EQ(one.speed2, other.speed2);
    }
  }
}

// The parts of works that a checkpoint keeps: sums do not depend on where a run was interrupted.
TEST(Device, WorksGoOnFromTheirParts) {
  const Case c = floating_case(1, true, true);
  const auto make = [](Dynamics& run) {
    device::DescribedModel described = device::describe(run.model(), "loop");
    auto engine = device::make_loop_engine({described.lattice});
    return DeviceStepper(run.model(), std::move(described), std::move(engine));
  };
  const auto steps = [&](DeviceStepper& stepper, int first, int end) {
    for (int n = first; n < end; ++n) stepper.queue(n * c.dt, c.dt, n > 0 ? c.dt : 0);
    (void)stepper.flush();
  };
  for (const bool keeps : {true, false}) {
    const auto run = at_start(c);
    WorkLedger ledger(run->model());
    const std::vector<double> zeros(ledger.all().begin(), ledger.all().end());
    DeviceStepper whole = make(*run), first = make(*run), second = make(*run);
    whole.put(run->state(), {zeros, 0, {}});
    first.put(run->state(), {zeros, 0, {}});
    steps(whole, 0, 60);
    steps(first, 0, 23);
    first.get(run->state());
    const double boundaries = first.take_works(ledger.all());
    DeviceStepper::WorkParts parts = first.work_parts();
    std::vector<double> sums = zeros;
    EXPECT_EQ(first.sum(parts, sums), boundaries);
    EXPECT_TRUE(std::equal(sums.begin(), sums.end(), ledger.all().begin()));
    second.put(run->state(), keeps ? parts : DeviceStepper::WorkParts{sums, boundaries, {}});
    steps(second, 23, 60);
    (void)second.take_works(sums);
    (void)whole.take_works(ledger.all());
    // Else they are the same to rounding only.
    EXPECT_EQ(std::equal(sums.begin(), sums.end(), ledger.all().begin()), keeps);
    for (std::size_t k = 0; k < sums.size(); ++k)
      EXPECT_NEAR(sums[k], ledger.all()[k], 1e-12 * std::abs(sums[k]));
    parts.since.drag.pop_back();
    EXPECT_FALSE(first.sum(parts, sums));
  }
}

TEST(Device, RunsTogetherAreWhatTheyAreAlone) {
  const std::vector<Case> cases{sheet_case(), floating_case(3), sheet_case()};
  std::vector<std::unique_ptr<Dynamics>> runs;
  std::vector<device::Lattice> lattices;
  std::vector<std::vector<std::int32_t>> orders;
  for (std::size_t r = 0; r < cases.size(); ++r) {
    Case c = cases[r];
    if (r == 2) c.lattice = test::sheet(7, 5, 1), c.dt = 1e-4, c.scene.loads.pop_back();
    runs.push_back(at_start(c));
    device::DescribedModel described = device::describe(runs.back()->model(), "loop");
    lattices.push_back(described.lattice);
    orders.push_back(described.order);
  }
  const std::array<int, 3> counts{6, 9, 4};
  const auto steps_of = [&](std::size_t r) {
    const double dt = r == 2 ? 1e-4 : 2e-4;
    device::Steps steps{.count = counts[r], .dt = dt, .before = 0};
    for (int n = 0; n < counts[r]; ++n) {
      for (const double at : {n * dt, n * dt + dt}) {
        for (const PlacedBoundary& placed : runs[r]->model().boundaries()) {
          const auto values = placed.boundary.value(at);
          steps.motions.insert(steps.motions.end(), values.begin(), values.end());
        }
      }
      for (const double number : {0.1 * n, 0.2, 0.3, 0.4}) steps.water.push_back(number);
      for (int l = 0; l < lattices[r].loads; ++l) {
        for (int k = 0; k < 6; ++k) steps.wrenches.push_back(100.0 * (k + 1) * (l + 1) * (n + 1));
      }
    }
    return steps;
  };
  const auto records_of = [&](std::size_t r) {
    std::vector<double> records;
    for (const std::int32_t b : orders[r]) {
      const double* from = runs[r]->state().record(static_cast<std::size_t>(b));
      records.insert(records.end(), from, from + Spatial::record);
    }
    return records;
  };
  const auto together = device::make_loop_engine(lattices, 16);
  std::vector<device::Steps> all;
  for (std::size_t r = 0; r < cases.size(); ++r) {
    together->put(r, records_of(r));
    all.push_back(steps_of(r));
  }
  together->step(all);
  for (std::size_t r = 0; r < cases.size(); ++r) {
    const auto alone = device::make_loop_engine({lattices[r]}, 64);
    alone->put(0, records_of(r));
    alone->step({&all[r], 1});
    std::vector<double> here = records_of(r), there = here;
    alone->get(0, there);
    EXPECT_NE(here, there);
    together->get(r, here);
    EXPECT_EQ(here, there) << r;
    const device::Works a = together->works(r), b = alone->works(0);
    EXPECT_EQ(a.beams, b.beams);
    EXPECT_EQ(a.held, b.held);
    EXPECT_EQ(a.loaded, b.loaded);
    if (lattices[r].water) {
      EXPECT_EQ(a.drag, b.drag);
      EXPECT_NE(a.drag[5], 0);
    }
    EXPECT_EQ(together->findings(r).speed2, alone->findings(0).speed2);
    EXPECT_EQ(together->findings(r).speed2, 0);  // asked once, findings begin anew
    together->forget_works(r);
    for (const double work : together->works(r).beams) EXPECT_EQ(work, 0);
  }
}

// A tile computes every beam that touches one of its bodies, once.
TEST(Device, TilesHaveTheirBeams) {
  const Case c = sheet_case();
  const auto run = at_start(c);
  const device::Lattice lattice = device::describe(run->model(), "loop").lattice;
  const device::Tiles tiles = device::make_tiles({&lattice, 1}, 20, 70);
  ASSERT_GT(tiles.run.size(), 4U);
  std::vector<int> seen(lattice.ends.size());
  for (std::size_t t = 0; t < tiles.run.size(); ++t) {
    const std::int32_t first = tiles.first_body[t], end = tiles.first_body[t + 1];
    EXPECT_LE(end - first, 20);
    EXPECT_LE(tiles.first_slot[t + 1] - tiles.first_slot[t], 70);
    const auto owns = [&](std::int32_t body) { return body >= first && body < end; };
    std::size_t expected = 0;
    for (const auto& [i, j] : lattice.ends) expected += owns(i) || owns(j) ? 1 : 0;
    EXPECT_EQ(expected, static_cast<std::size_t>(tiles.first_slot[t + 1] - tiles.first_slot[t]));
    for (std::int32_t s = tiles.first_slot[t]; s < tiles.first_slot[t + 1]; ++s) {
      const auto at = static_cast<std::size_t>(s);
      EXPECT_TRUE(owns(tiles.i[at]) || owns(tiles.j[at]));
      ++item(seen, tiles.beam[at]);
    }
  }
  for (const int times : seen) EXPECT_GE(times, 1);
  // Bodies near each other share a tile: few beams are computed twice.
  EXPECT_LT(std::accumulate(seen.begin(), seen.end(), 0), 1.6 * static_cast<double>(seen.size()));
}

TEST(Device, FindsASpeedThatIsNotFinite) {
  const Case c = sheet_case();
  const auto run = at_start(c);
  device::DescribedModel described = device::describe(run->model(), "loop");
  auto engine = device::make_loop_engine({described.lattice});
  DeviceStepper stepper(run->model(), std::move(described), std::move(engine));
  run->state().record(3)[Spatial::velocity] = std::nan("");
  const WorkLedger ledger(run->model());
  stepper.put(run->state(), {{ledger.all().begin(), ledger.all().end()}, 0, {}});
  for (int n = 0; n < 3; ++n) stepper.queue(n * c.dt, c.dt, c.dt);
  EXPECT_FALSE(std::isfinite(stepper.flush()));
}

TEST(Device, WhatIsNotThereYetIsRefusedByName) {
  const auto refused = [](const std::function<void(Case&)>& change) {
    Case c = sheet_case();
    change(c);
    return error_of([&] {
      Dynamics run(c.scene, c.lattice);
      (void)device::describe(run.model(), "cuda");
    });
  };
  EXPECT_EQ(refused([](Case&) {}), "");
  const std::string breaking = refused([](Case& c) {
    c = breaking_case();
    c.scene.fracture.propagation = Propagation::energy;
  });
  EXPECT_TRUE(contains(breaking, "backend: cuda has no fracture: propagation: energy yet"))
      << breaking;
  const std::string faces = refused([](Case& c) {
    c = floating_case();
    c.scene.drag = {.density = 1010, .faces = true, .form = 1, .skin = 0.01};
  });
  EXPECT_TRUE(contains(faces, "has no water: drag: faces yet")) << faces;
}

}  // namespace
}  // namespace floe
