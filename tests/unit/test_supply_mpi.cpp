// Ice without end: the mesh of its strips, and a run that is fed with them.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "explicit/step.h"
#include "floe/base/item.h"
#include "floe/base/petsc.h"
#include "floe/mesh/strips.h"
#include "floe/simulation.h"
#include "scene_model/scene_model.h"
#include "scene_model/supplied_ice.h"
#include "support/scene_options.h"

namespace floe {
namespace {

SheetPlan strip_plan() {
  SheetPlan plan;
  plan.length = 16, plan.width = 10, plan.element_size = 2, plan.iterations = 40, plan.seed = 3;
  return plan;
}

bool is_same(const StripCells& a, const StripCells& b) {
  const auto same = [](const std::vector<Facet>& x, const std::vector<Facet>& y) {
    return std::equal(x.begin(), x.end(), y.begin(), y.end(), [](const Facet& f, const Facet& g) {
      return f.cells == g.cells && f.width == g.width;
    });
  };
  return a.offset == b.offset && a.vertices == b.vertices && a.sides == b.sides &&
         same(a.inside, b.inside) && same(a.to_next, b.to_next);
}

double width_of(const std::vector<Facet>& facets) {
  double sum = 0;
  for (const Facet& facet : facets) sum += facet.width;
  return sum;
}

/// Lengths of all edges of the polygons of a strip, and of those on its sides [m].
std::array<double, 2> edges_of(const StripCells& strip, const SheetPlan& plan) {
  double all = 0, outer = 0;
  for (std::size_t c = 0; c + 1 < strip.offset.size(); ++c) {
    const auto first = static_cast<std::size_t>(strip.offset[c]),
               end = static_cast<std::size_t>(strip.offset[c + 1]);
    for (std::size_t v = first; v < end; ++v) {
      const auto &p = strip.vertices[v], &q = strip.vertices[v + 1 < end ? v + 1 : first];
      const double length = std::hypot(q[0] - p[0], q[1] - p[1]);
      const auto on = [&](std::size_t axis, double at) {
        return std::abs(p[axis] - at) < 1e-9 && std::abs(q[axis] - at) < 1e-9;
      };
      all += length;
      if (on(1, plan.width / 2) || on(1, -plan.width / 2)) outer += length;
    }
  }
  return {all, outer};
}

TEST(Strips, AreTheSameWhereverTheyBegin) {
  Strips from_right(strip_plan(), PETSC_COMM_WORLD), from_left(strip_plan(), PETSC_COMM_SELF);
  for (std::int32_t k = 0; k < 4; ++k) (void)from_right.strip(k);
  for (std::int32_t k = 3; k >= 0; --k)
    EXPECT_TRUE(is_same(from_right.strip(k), from_left.strip(k))) << k;
  const std::vector<std::int32_t> kept{3};
  from_right.forget(kept);
  EXPECT_TRUE(is_same(from_right.strip(1), from_left.strip(1)));
  EXPECT_FALSE(is_same(from_right.strip(1), from_right.strip(2)));
}

/// Every edge of a cell is a facet to a cell of its strip or the next ones, or lies on a side; and
/// joints are no lines of facets.
TEST(Strips, FitTogether) {
  const SheetPlan plan = strip_plan();
  Strips strips(plan, PETSC_COMM_WORLD);
  for (std::int32_t k = 1; k < 4; ++k) {
    const StripCells strip = strips.strip(k), before = strips.strip(k - 1);
    const auto [all, outer] = edges_of(strip, plan);
    EXPECT_NEAR(all - outer,
                2 * width_of(strip.inside) + width_of(strip.to_next) + width_of(before.to_next),
                1e-9 * all);
    EXPECT_NEAR(outer, 2 * plan.length, 2 * plan.element_size);
    EXPECT_GT(width_of(strip.to_next), 1.05 * plan.width) << "a straight joint";
  }
}

constexpr auto scene_text = R"(integrator: explicit
forces: [beam, gravity, buoyancy, drag]
ice: {young: 4e6}
sheet: {length: 24, width: 6, thickness: 0.5, element_size: 1.5, iterations: 20}
supply: {strip: 12, length: 48}
beam: {damping_ratio: 0.1}
water: {drag_coefficient: 1, drag_linear: 200, current: [9.9, 0, 0]}
boundary: {names: [push], push: {set: left, fix: x y z rx ry rz, velocity: [10, 0, 0]}}
initial: {names: [all], all: {set: all, velocity: [9.9, 0, 0.05]}}
time: {end: 4, dt: 0.004}
output: {overwrite: true}
)";

Scene fed_scene() {
  UserOptions user{{}, parse_scene("fed.yaml", scene_text), {}};
  return read_scene("fed.yaml", user);
}

/// The run in which all strips exist from the start, those outside of the window prescribed:
/// displacements of all bodies at the end.
std::vector<Point3> reference(const Scene& scene, std::int64_t every) {
  SuppliedIce ice(scene, PETSC_COMM_SELF);
  std::vector<Lattice> windows{ice.lattice()};
  while (ice.can_join()) windows.push_back(ice.join(0).lattice);
  Lattice all = windows.back();
  set_initial(scene, all);
  const Boundary edge = ice.edge();
  const double dt = scene.time.dt;
  const auto steps = std::llround(scene.time.end / dt);
  std::vector<double> records;
  double time = 0;
  std::int64_t step = 0;
  for (std::size_t p = 0; p < windows.size(); ++p) {
    std::vector<Boundary> boundaries{edge};
    all.sets["left"] = windows[p].sets["left"];
    std::vector<std::int32_t>& outside = all.sets["outside"];
    outside.clear();
    for (std::int32_t b = windows[p].bodies.size(); b < all.bodies.size(); ++b)
      outside.push_back(b);
    if (!outside.empty()) {
      Boundary rest = edge;
      rest.name = rest.set = "outside";
      rest.fixed = {true, true, true, true, true, true};
      boundaries.push_back(rest);
    }
    Model<Spatial> model(all, PETSC_COMM_SELF, boundaries);
    add_forces(scene, {}, model, &all);
    State<Spatial> state(static_cast<std::size_t>(all.bodies.size()));
    Wrenches<Spatial> wrenches(static_cast<std::size_t>(all.bodies.size()));
    WorkLedger works(model);
    ExplicitStep<Spatial> stepper(model, state, wrenches, works);
    if (p == 0) {
      stepper.start();
      stepper.stagger(dt);
    } else {
      state.records = records;
      state.set_time(time);
    }
    const double due = static_cast<double>(p + 1) * scene.supply.strip;
    const auto ends = [&] {
      return step % every == 0 && p + 1 < windows.size() && edge.value(state.time)[0] >= due;
    };
    while (step < steps && !ends()) {
      if (step > 0) stepper.evaluate();  // the first kick is with the forces of the start
      (void)stepper.advance(dt);
      stepper.commit(dt);
      state.time = static_cast<double>(++step) * dt;
    }
    records = state.records;
    time = state.time;
  }
  std::vector<Point3> places;
  for (std::size_t b = 0; b < static_cast<std::size_t>(all.bodies.size()); ++b) {
    const double* u = &records[b * Spatial::record];
    places.push_back(all.bodies.position[b] + Vec3<double>{u[0], u[1], u[2]});
  }
  return places;
}

TEST(Supply, IsTheRunInWhichAllStripsExist) {
  const Scene scene = fed_scene();
  const std::vector<Point3> expected = reference(scene, SupplyOptions{}.every);
  Simulation simulation(scene, {.talks = false});
  (void)simulation.run();
  std::size_t bodies = 0;
  double largest = 0;
  // Bodies move by other ways than the far edge.
  SuppliedIce ice(scene, PETSC_COMM_SELF);
  const double way = ice.edge().value(scene.time.end)[0];
  const Lattice first = ice.lattice();
  double strained = 0;
  for (std::int32_t b = 0; b < first.bodies.size(); ++b)
    strained =
        std::max(strained, std::abs(item(expected, b).x - item(first.bodies.position, b).x - way));
  for (const BodyState& body : simulation.bodies()) {
    ++bodies;
    const Vec3<double> miss = body.position - item(expected, body.body);
    largest = std::max({largest, std::abs(miss.x), std::abs(miss.y), std::abs(miss.z)});
  }
  EXPECT_LT(largest, 1e-9);
  EXPECT_GT(strained, 0.01) << "nothing happens";
  if (size() == 1) {
    EXPECT_EQ(bodies, expected.size());
  }
  EXPECT_EQ(expected.size() % 4, 0U);
}

}  // namespace
}  // namespace floe
