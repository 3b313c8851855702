// Contacts by the text of devices, in loops on the processor: their steps are those of the lanes.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "device/device_stepper.h"
#include "floe/base/item.h"
#include "support/alike.h"
#include "support/contact_scene.h"
#include "support/random.h"
#include "support/scene_options.h"

namespace floe {
namespace {

using device::DeviceStepper;
using test::Dynamics;

/// A scene and its lattice, stepped on the processor until bodies touch.
struct Case {
  Scene scene;
  Lattice lattice;
  double dt = 1e-3;
  int steps_before = 0;
};

/// Stones in a heap that fall and roll on a floor, against a box that turns in their midst.
Case stones(ContactLaw law, double restitution, double friction) {
  Case c;
  c.scene = test::contact_scene(2e6, friction, restitution);
  c.scene.contact.law = law;
  c.scene.contact.friction_wet = 0.1;
  test::Random random(11);
  for (int k = 0; k < 27; ++k) {
    const Vec3<double> at{1.6 * (k % 3 - 1), 1.6 * (k / 3 % 3 - 1), 1.4 + 1.6 * (k / 9)};
    test::append_stone(c.lattice, random, at + random.vector(0.1),
                       random.rotation(random.uniform(0, 3)),
                       random.vector(1) + Vec3<double>{0, 0, -2}, random.vector(1));
  }
  c.scene.contact.initial_overlap = InitialOverlap::stress_free;
  test::append_obstacle(c.scene, "floor", half_space({0, 0, 0}, {0.1, 0, 1}));
  Obstacle& paddle = test::append_obstacle(c.scene, "paddle", box({0, 0, 0.6}, {6, 0.4, 0.8}, {}));
  paddle.motion.angular_velocity = {0, 0, 1.5};
  paddle.motion.velocity = {0.2, 0, 0};
  paddle.motion.ramp.seconds = 0.1;
  c.dt = 5e-4;
  c.steps_before = 300;
  return c;
}

/// Blocks between a block that a boundary pushes and turns, and one that is held.
Case pushed_blocks() {
  Case c;
  c.scene = test::contact_scene(1e7, 0.4, 0.3);
  for (int k = 0; k < 5; ++k)
    test::append_block(c.lattice, {1, 1.2, 0.8 + 0.1 * (k % 2)}, {0.9995 * k, 0.01 * k, 0.1},
                       {1, 0, 0, 0}, {k == 0 ? 0.3 : 0.0, 0, 0});
  c.lattice.sets["first"] = {0};
  c.lattice.sets["last"] = {4};
  Boundary pusher, held;
  pusher.name = pusher.set = "first", pusher.fixed = {true, true, false, false, true, false};
  pusher.velocity = Point3{0.3, 0.05, 0}, pusher.angular_velocity = {0, 0.2, 0};
  pusher.ramp.seconds = 0.2;
  held.name = held.set = "last", held.fixed.fill(true);
  c.scene.boundaries = {pusher, held};
  test::append_obstacle(c.scene, "floor", half_space({0, 0, -0.3}, {0, 0, 1}));
  c.dt = 2e-4;
  c.steps_before = 100;
  return c;
}

std::unique_ptr<Dynamics> started(const Case& of) {
  auto run = std::make_unique<Dynamics>(of.scene, of.lattice);
  run->set_step(of.dt);
  run->steps(of.steps_before);
  return run;
}

/// What is reported of contacts and obstacles, and the works of the forces without the share of the
/// evaluation at the state.
struct Stepped {
  State<Spatial> state;
  std::vector<double> works;
  double contacts = 0, stored = 0;
  std::vector<double> columns;  ///< of obstacles
  std::vector<WornPlane> worn;
};

std::vector<double> works_without_last(Dynamics& run, double dt) {
  std::vector<double> works = run.works();
  std::size_t first = 0;
  for (const auto& force : run.model().forces()) {
    const DoesWork<Spatial>* role = force->roles().work;
    if (role == nullptr) continue;
    std::vector<double> powers(role->works());
    role->powers(powers);
    for (const double power : powers) works[first++] -= 0.5 * dt * power;
  }
  return works;
}

Stepped looked_at(Dynamics& run) {
  Stepped out;
  run.evaluate();
  out.state = run.state();
  out.contacts = run.reported("contacts");
  out.stored = run.reported("energy_contact");
  for (const std::string obstacle : {"floor", "paddle"}) {
    for (const std::string what : {"_force_", "_moment_", "_peak_force_", "_mean_force_"}) {
      for (const std::string axis : {"x", "y", "z"})
        out.columns.push_back(run.reported(obstacle + what + axis));
    }
  }
  out.worn = device::describe(run.model(), "loop").numbers.contacts->kept->worn();
  return out;
}

Stepped by_lanes(const Case& of, int steps) {
  const auto run = started(of);
  const std::vector<double> before = works_without_last(*run, of.dt);
  run->steps(steps);
  Stepped out = looked_at(*run);
  out.works = works_without_last(*run, of.dt);
  for (std::size_t w = 0; w < before.size(); ++w) out.works[w] -= before[w];
  return out;
}

/// \param queued  steps that are made at once \param looks  whether the state is brought back then
/// \param lists   whether the engine lists pairs by itself
Stepped by_loop(const Case& of, int steps, std::int32_t tile = 0, int queued = 7,
                bool looks = false, bool lists = true) {
  const auto run = started(of);
  device::DescribedModel described = device::describe(run->model(), "loop");
  if (!lists) described.lattice.contacts->listing.reset();
  auto engine = device::make_loop_engine({described.lattice}, tile);
  DeviceStepper stepper(run->model(), std::move(described), std::move(engine));
  WorkLedger ledger(run->model());
  stepper.put(run->state(), {{ledger.all().begin(), ledger.all().end()}, 0, {}});
  const double begin = run->state().time;
  const auto bring = [&](int made) {
    stepper.get(run->state());
    run->state().time = begin + made * of.dt;
    run->state().velocity_time = run->state().time - 0.5 * of.dt;
  };
  for (int n = 0; n < steps; ++n) {
    stepper.queue(begin + n * of.dt, of.dt, of.dt);
    if ((n + 1) % queued != 0) continue;
    (void)stepper.flush();
    if (!looks) continue;
    bring(n + 1);
    run->evaluate();
  }
  (void)stepper.flush();
  bring(steps);
  (void)stepper.take_works(ledger.all());
  Stepped out = looked_at(*run);
  out.works.assign(ledger.all().begin(), ledger.all().end());
  return out;
}

void expect_alike(const Stepped& a, const Stepped& b, double tolerance) {
  test::expect_alike(a.state, b.state, tolerance);
}

void expect_numbers(const std::vector<double>& a, const std::vector<double>& b, double tolerance) {
  ASSERT_EQ(a.size(), b.size());
  double largest = 0;
  for (const double x : a) largest = std::max(largest, std::abs(x));
  for (std::size_t k = 0; k < a.size(); ++k) EXPECT_NEAR(a[k], b[k], tolerance * largest) << k;
}

/// Stones that crush each other, and lose it.
Case wearing_stones() {
  Case c = stones(ContactLaw::overlap, 0.5, 0.3);
  c.scene.contact.plastic_limit = {.pressure = 5e4,
                                   .area = 0.5,
                                   .exponent = 0.4,
                                   .least = 1e4,
                                   .most = 2e5,
                                   .fast = 0.5,
                                   .speed = 0.3};
  c.steps_before = 1200;
  return c;
}

std::vector<Case> all_cases() {
  Case periodic = stones(ContactLaw::overlap, 0.6, 0.3);
  periodic.scene.contact.periods.length = {0, 9, 0};
  periodic.scene.periods = periodic.scene.contact.periods;
  Case crushing = wearing_stones();
  crushing.scene.contact.wear = false;
  return {stones(ContactLaw::overlap, 0.5, 0.3),
          stones(ContactLaw::potential, 0.4, 0.5),
          stones(ContactLaw::potential, 1, 0.3),
          stones(ContactLaw::overlap, 1, 0),
          pushed_blocks(),
          crushing,
          wearing_stones(),
          periodic};
}

// Forces to rounding: by the velocities that they give in a step.
TEST(DeviceContact, AStepIsThatOfTheLanes) {
  int k = 0;
  for (const Case& c : all_cases()) {
    SCOPED_TRACE(k++);
    const Stepped lanes = by_lanes(c, 1), loop = by_loop(c, 1);
    EXPECT_GT(lanes.contacts, 3);
    expect_alike(lanes, loop, 1e-15);
    EXPECT_EQ(lanes.contacts, loop.contacts);
  }
}

double difference_of_places(const State<Spatial>& a, const State<Spatial>& b) {
  double most = 0;
  for (std::size_t body = 0; body < a.records.size() / Spatial::record; ++body)
    most = std::max(most, length(displacement(a, body) - displacement(b, body)));
  return most;
}
double slack_of(Dynamics& run) {
  return device::describe(run.model(), "loop").numbers.contacts->slack;
}

// Contacts, histories, forces on obstacles and works too; lists of pairs expire on the way.
TEST(DeviceContact, AHundredStepsAreThoseOfTheLanes) {
  int k = 0;
  for (const Case& c : all_cases()) {
    SCOPED_TRACE(k++);
    const Stepped lanes = by_lanes(c, 100), loop = by_loop(c, 100);
    expect_alike(lanes, loop, 1e-9);
    EXPECT_EQ(lanes.contacts, loop.contacts);
    if (k < 5) {  // the list has expired on the way
      const auto start = started(c);
      EXPECT_GT(difference_of_places(start->state(), lanes.state), slack_of(*start));
    }
    EXPECT_GT(lanes.stored, 0);
    EXPECT_NEAR(loop.stored, lanes.stored, 1e-7 * lanes.stored);
    expect_numbers(lanes.columns, loop.columns, 1e-7);
    expect_numbers(lanes.works, loop.works, 1e-8);
    const std::size_t last = lanes.works.size() - 4;
    const bool damps = c.scene.contact.damping_ratio > 0, rubs = c.scene.contact.friction > 0;
    const std::array<bool, 3> works{true, damps, rubs};
    for (std::size_t w = 0; w < works.size(); ++w) EXPECT_EQ(lanes.works[last + w] != 0, works[w]);
  }
}

// Contacts part on the way: the same bodies lose the same, and what they have left is what touches.
TEST(DeviceContact, BodiesWearAsByTheLanes) {
  const Case c = wearing_stones();
  const Stepped start = by_lanes(c, 0), lanes = by_lanes(c, 800), loop = by_loop(c, 800);
  EXPECT_GT(start.worn.size(), 0);  // before the engine takes over
  EXPECT_GT(lanes.worn.size(), start.worn.size() + 10);
  ASSERT_EQ(lanes.worn.size(), loop.worn.size());
  for (std::size_t k = 0; k < lanes.worn.size(); ++k) {
    EXPECT_EQ(lanes.worn[k].body, loop.worn[k].body);
    EXPECT_LE(length(lanes.worn[k].left.normal - loop.worn[k].left.normal), 1e-6);
    EXPECT_NEAR(lanes.worn[k].left.offset, loop.worn[k].left.offset, 1e-6);
  }
  expect_alike(lanes, loop, 1e-6);
  Case heals = c;
  heals.scene.contact.wear = false;
  EXPECT_GT(difference_of_places(by_loop(heals, 800).state, loop.state), 1e-3);
}

TEST(DeviceContact, TilesQueuesAndLooksChangeNoBit) {
  for (const Case& c :
       {stones(ContactLaw::potential, 0.4, 0.5), pushed_blocks(), wearing_stones()}) {
    const Stepped one = by_loop(c, 60, 32);
    for (const std::int32_t tile : {1, 3, 64}) {
      for (const int queued : {1, 2, 60}) {
        const Stepped other = by_loop(c, 60, tile, queued, queued == 2);
        EXPECT_EQ(one.state.records, other.state.records) << tile << " " << queued;
        EXPECT_EQ(one.works, other.works);
        EXPECT_EQ(one.columns, other.columns);
        EXPECT_EQ(one.stored, other.stored);
      }
    }
  }
}

/// Two blocks whose shapes overlap, joined by a beam that shears and breaks, and a third one.
Case breaking_blocks() {
  Case c;
  constexpr double apart = 0.95, speed = 2;
  test::append_block(c.lattice, {1, 1, 1}, {0, 0, 0}, {1, 0, 0, 0}, {0.2, 0, -0.5 * speed});
  test::append_block(c.lattice, {1, 1, 1}, {apart, 0, 0}, {1, 0, 0, 0}, {-0.2, 0, 0.5 * speed});
  test::append_block(c.lattice, {1, 1, 1}, {-1.0005, 0, 0}, {1, 0, 0, 0}, {1, 0, 0});
  Beams& b = c.lattice.beams;
  b.bodies = {{0, 1}};
  b.area = {1}, b.width = {1}, b.height = {1}, b.length = {apart};
  b.inertia_y = b.inertia_z = {1.0 / 12}, b.torsion = {saint_venant_torsion(1, 1)};
  b.young = {1e8}, b.shear_modulus = {4e7}, b.shear_factor = {5.0 / 6}, b.axis_y = {{0, 1, 0}};
  c.scene = test::contact_scene(1e7, 0.2, 0.5, false);
  c.scene.forces.beam = c.scene.forces.fracture = true;
  c.scene.fracture.tensile_strength = c.scene.fracture.shear_strength = 1e5;
  c.dt = 2e-5;
  c.steps_before = 5;
  return c;
}

/// Bodies of several pieces of a sheet, of which beams break, and a large plate over them.
Case pieces_and_a_plate() {
  Case c = breaking_blocks();
  for (int k = 0; k < 6; ++k)
    test::append_block(c.lattice, {1, 1, 0.5}, {1.01 * k - 2, 0.02 * k, -1.2}, {1, 0, 0, 0},
                       {0.2 - 0.1 * k, 0, 0.5});
  test::append_block(c.lattice, {9, 9, 0.5}, {0, 0, 1.1}, {1, 0, 0, 0}, {0, 0, -1});
  c.scene.contact.young_broken = 2e7;
  test::append_obstacle(c.scene, "floor", half_space({0, 0, -1.5}, {0, 0, 1}));
  c.steps_before = 300;
  c.dt = 2e-4;
  return c;
}

/// Cases with lists of all kinds.
std::vector<Case> listed_cases() {
  std::vector<Case> cases = all_cases();
  cases.push_back(pieces_and_a_plate());
  for (const double period : {9.0, 5.0, 3.2}) {  // three and more cells of a period, two, one
    Case c = stones(ContactLaw::overlap, 0.6, 0.3);
    c.scene.contact.periods.length = {period, period, 0};
    c.scene.periods = c.scene.contact.periods;
    c.scene.obstacles.pop_back();
    c.steps_before = 20;
    if (period < 5) c.lattice = {};
    test::Random random(12);
    for (int k = 0; k < 6 && period < 5; ++k)
      test::append_stone(c.lattice, random, {0.9 * k - 2, 0.4 * k, 1.1 * k + 1},
                         random.rotation(random.uniform(0, 3)), {0, 0, -2}, random.vector(1));
    cases.push_back(c);
  }
  return cases;
}

// An engine's list has the pairs of the processor's, in the same order and with the same numbers;
// what it has beside them are pairs that only an axis between edges separates.
TEST(DeviceContact, AnEngineListsThePairs) {
  int number = 0;
  std::size_t pairs = 0, more = 0;
  for (const Case& c : listed_cases()) {
    SCOPED_TRACE(number++);
    const auto run = started(c);
    device::DescribedModel described = device::describe(run->model(), "loop");
    const DeviceContacts contacts = *described.numbers.contacts;
    const std::vector<std::int32_t> place = described.place;
    const auto engine = device::make_loop_engine({described.lattice}, 0);
    std::vector<double> records, obstacles;
    for (const std::int32_t b : described.order) {
      const double* from = run->state().record(static_cast<std::size_t>(b));
      records.insert(records.end(), from, from + Spatial::record);
    }
    engine->put(0, records);
    for (std::size_t k = 0; k < contacts.obstacles; ++k) {
      const auto numbers = contacts.obstacle(k, run->state().time, c.dt, c.dt);
      obstacles.insert(obstacles.end(), numbers.begin(), numbers.begin() + 12);
    }
    const DevicePairs listed = contacts.kept->list(run->state());
    const auto bodies = static_cast<std::int32_t>(place.size());
    device::Pairs given{{}, listed.numbers, listed.histories, listed.states, listed.crushes, {}};
    for (const auto& [a, b] : listed.bodies)
      given.solids.push_back({item(place, a), b < 0 ? bodies - 1 - b : item(place, b)});
    for (const std::int32_t b : described.order) {
      given.eligible.pieces.push_back(item(listed.pieces, b));
      given.eligible.states.push_back(
          static_cast<std::uint8_t>(item(listed.on_surface, b) + 2 * item(listed.left_out, b)));
    }
    for (const auto& [a, b] : listed.broken)
      given.eligible.broken.push_back({item(place, a), item(place, b)});
    engine->put_pairs(0, given);
    ASSERT_TRUE(engine->list_pairs(0, obstacles));
    device::Pairs made;
    engine->get_pairs(0, made);
    std::size_t at = 0;
    for (std::size_t k = 0; k < given.solids.size(); ++k) {
      while (at < made.solids.size() && made.solids[at] != given.solids[k]) ++at;
      ASSERT_LT(at, made.solids.size()) << k << " of " << given.solids.size();
      EXPECT_EQ(made.numbers[at], given.numbers[k]);
      EXPECT_EQ(made.states[at], given.states[k]);
      if ((given.states[k] & DevicePairs::touching) != 0) {
        EXPECT_EQ(made.histories[at], given.histories[k]);
      }
      if ((given.states[k] & DevicePairs::crushed) != 0) {
        EXPECT_EQ(made.crushes[at], given.crushes[k]);
      }
    }
    pairs += given.solids.size();
    more += made.solids.size() - given.solids.size();
  }
  EXPECT_GT(pairs, 300);
  EXPECT_LT(more, pairs / 10);
}

// Who makes a list changes no bit: lists expire on the way.
TEST(DeviceContact, WhoListsChangesNoBit) {
  int number = 0;
  for (const Case& c : listed_cases()) {
    SCOPED_TRACE(number++);
    const Stepped by_engine = by_loop(c, 200), by_host = by_loop(c, 200, 0, 7, false, false);
    EXPECT_EQ(by_engine.state.records, by_host.state.records);
    EXPECT_EQ(by_engine.works, by_host.works);
    EXPECT_EQ(by_engine.columns, by_host.columns);
    EXPECT_EQ(by_engine.stored, by_host.stored);
  }
}

// Two runs in an engine have the bits that they have alone, also where the list of one is made anew
// and grows.
TEST(DeviceContact, RunsTogetherAreWhatTheyAreAlone) {
  const std::vector<Case> cases{stones(ContactLaw::overlap, 0.5, 0.3), pushed_blocks(),
                                wearing_stones(), stones(ContactLaw::potential, 1, 0.3)};
  std::vector<std::unique_ptr<Dynamics>> runs;
  std::vector<device::Lattice> lattices;
  std::vector<device::DescribedModel> described;
  for (const Case& c : cases) {
    runs.push_back(started(c));
    described.push_back(device::describe(runs.back()->model(), "loop"));
    lattices.push_back(described.back().lattice);
  }
  const auto records_of = [&](std::size_t r) {
    std::vector<double> records;
    for (const std::int32_t b : described[r].order) {
      const double* from = runs[r]->state().record(static_cast<std::size_t>(b));
      records.insert(records.end(), from, from + Spatial::record);
    }
    return records;
  };
  const auto pairs_of = [&](std::size_t r) {
    const DevicePairs listed = described[r].numbers.contacts->kept->list(runs[r]->state());
    device::Pairs pairs{{}, listed.numbers, listed.histories, listed.states, listed.crushes, {}};
    const auto bodies = static_cast<std::int32_t>(described[r].order.size());
    for (const auto& [a, b] : listed.bodies)
      pairs.solids.push_back(
          {item(described[r].place, a), b < 0 ? bodies - 1 - b : item(described[r].place, b)});
    return pairs;
  };
  const auto worn_of = [&](std::size_t r) {
    std::vector<device::WornPlane> planes;
    for (const auto& [body, left] : described[r].numbers.contacts->kept->worn())
      planes.push_back({item(described[r].place, body), left});
    return planes;
  };
  const auto steps_of = [&](std::size_t r) {
    const DeviceContacts& contacts = *described[r].numbers.contacts;
    const double dt = cases[r].dt, begin = runs[r]->state().time;
    device::Steps steps{.count = 5 + static_cast<int>(r), .dt = dt, .before = dt};
    for (int n = 0; n < steps.count; ++n) {
      const double time = begin + n * dt;
      for (std::size_t k = 0; k < contacts.obstacles; ++k) {
        const auto numbers = contacts.obstacle(k, time, dt, dt);
        steps.obstacles.insert(steps.obstacles.end(), numbers.begin(), numbers.end());
      }
      for (const double at : {time, time + dt}) {
        for (const PlacedBoundary& placed : runs[r]->model().boundaries()) {
          const auto values = placed.boundary.value(at);
          steps.motions.insert(steps.motions.end(), values.begin(), values.end());
        }
      }
      for (const PlacedBoundary& placed : runs[r]->model().boundaries()) {
        const auto values = placed.boundary.acceleration(time);
        steps.accelerations.insert(steps.accelerations.end(), values.begin(), values.end());
      }
    }
    return steps;
  };
  const auto together = device::make_loop_engine(lattices, 16);
  std::vector<device::Steps> all;
  for (std::size_t r = 0; r < cases.size(); ++r) {
    together->put(r, records_of(r));
    together->put_pairs(r, pairs_of(r));
    if (!worn_of(r).empty()) together->put_worn(r, worn_of(r));
    all.push_back(steps_of(r));
  }
  together->step(all);
  for (std::size_t r = 0; r < cases.size(); ++r) {
    const auto alone = device::make_loop_engine({lattices[r]}, 64);
    alone->put(0, records_of(r));
    alone->put_pairs(0, pairs_of(r));
    if (!worn_of(r).empty()) alone->put_worn(0, worn_of(r));
    alone->step({&all[r], 1});
    EXPECT_EQ(together->made(r).steps, alone->made(0).steps);
    EXPECT_EQ(together->made(r).why, alone->made(0).why);
    if (r != 2) {  // bodies of the third wear
      EXPECT_EQ(together->made(r).steps, all[r].count);
    }
    std::vector<double> here = records_of(r), there = here;
    alone->get(0, there);
    EXPECT_NE(here, there);
    together->get(r, here);
    EXPECT_EQ(here, there) << r;
    device::Pairs a, b;
    together->get_pairs(r, a);
    alone->get_pairs(0, b);
    EXPECT_EQ(a.histories, b.histories);
    EXPECT_EQ(a.states, b.states);
    EXPECT_EQ(a.crushes, b.crushes);
    EXPECT_GT(std::count_if(a.states.begin(), a.states.end(),
                            [](std::uint8_t state) { return state & DevicePairs::touching; }),
              3);
    EXPECT_EQ(together->works(r).contacts, alone->works(0).contacts);
    EXPECT_EQ(together->works(r).obstacles, alone->works(0).obstacles);
  }
}

// From the step after the break on the blocks touch, and what they overlap by has no energy.
TEST(DeviceContact, ABrokenBeamReleasesItsPair) {
  const Case c = breaking_blocks();
  const auto start = started(c);
  EXPECT_EQ(start->reported("beams_broken"), 0);
  EXPECT_EQ(looked_at(*start).contacts, 0);
  for (const int queued : {1, 7, 400}) {
    const Stepped lanes = by_lanes(c, 400), loop = by_loop(c, 400, 0, queued);
    EXPECT_EQ(lanes.contacts, 2);
    EXPECT_EQ(loop.contacts, 2);
    expect_alike(lanes, loop, 1e-10);
    EXPECT_NEAR(loop.stored, lanes.stored, 1e-8 * lanes.stored);
    EXPECT_GT(lanes.stored, 0);
  }
}

TEST(DeviceContact, WhatIsNotThereYetIsRefusedByName) {
  const auto refused = [](const std::function<void(Case&)>& change) {
    Case c = pushed_blocks();
    change(c);
    return error_of([&] {
      Dynamics run(c.scene, c.lattice);
      (void)device::describe(run.model(), "cuda");
    });
  };
  EXPECT_EQ(refused([](Case&) {}), "");
  const std::string parts = refused([](Case& c) {
    Obstacle two = box({0, 0, -5}, {1, 1, 1}, {});
    add_parts(two, box({0, 0, -6}, {1, 1, 1}, {}));
    test::append_obstacle(c.scene, "two", two);
  });
  EXPECT_TRUE(contains(parts, "backend: cuda has no obstacles of several convex parts yet"))
      << parts;
}

}  // namespace
}  // namespace floe
