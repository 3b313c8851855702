// The submerged parts that the forces of the water share: the same bits as each force finds alone,
// and, with a pace, to first order what it would find.

#include "submersion/submersion.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "support/box.h"
#include "support/force_checks.h"
#include "support/lattices.h"
#include "support/record.h"
#include "support/states.h"
#include "water/buoyancy.h"
#include "water/drag.h"

namespace floe {
namespace {

constexpr double weight = 1010 * 9.81;

/// Buoyancy and drag by shared submerged parts.
struct Water {
  std::shared_ptr<Submersion> submersion;
  std::unique_ptr<Force<Spatial>> buoyancy, drag;
  Water(const Part& part, int pace, const DragOptions& options)
      : submersion(std::make_shared<Submersion>(part, pace, true)),
        buoyancy(make_buoyancy(submersion, weight)),
        drag(options.faces ? make_face_drag(submersion, options, false)
                           : make_drag(submersion, options)) {}
  /// As the steps of leapfrog evaluate forces.
  std::vector<double> in_step(const State<Spatial>& state) {
    submersion->before_evaluation(state);
    std::vector<double> w = alone(state);
    submersion->after_evaluation();
    return w;
  }
  std::vector<double> alone(const State<Spatial>& state) {
    std::vector<double> w = test::wrenches_of(*buoyancy, state);
    const std::vector<double> other = test::wrenches_of(*drag, state);
    w.insert(w.end(), other.begin(), other.end());
    return w;
  }
};

DragOptions on_plan() { return {.linear = 300, .coefficient = 1}; }
DragOptions on_faces() {
  DragOptions options{.linear = 30, .current = {0.4, -0.2, 0}};
  options.faces = true;
  options.form = 1.1, options.skin = 0.05;
  return options;
}

/// A sheet of which some bodies are dry, some wet, some cut in all ways.
State<Spatial> tumbled(const Part& part, std::uint64_t seed) {
  State<Spatial> state(static_cast<std::size_t>(part.local));
  test::Random random(seed);
  for (std::size_t b = 0; b < static_cast<std::size_t>(part.owned); ++b) {
    double* r = state.record(b);
    const Vec3<double> u = random.vector(0.8), v = random.vector(1), w = random.vector(0.5);
    r[0] = u.x, r[1] = u.y, r[2] = u.z;
    test::put_rotation(state, b, random.rotation(b % 3 == 0 ? 3.0 : 0.1));
    for (std::size_t k = 0; k < 3; ++k) r[7 + k] = v[k], r[10 + k] = w[k];
  }
  return state;
}

/// The state with all bodies moved by `part` of some small motion.
State<Spatial> moved(const State<Spatial>& from, const Part& part, double size,
                     bool with_velocities) {
  State<Spatial> state = from;
  test::Random random(11);
  for (std::size_t b = 0; b < static_cast<std::size_t>(part.owned); ++b) {
    double* r = state.record(b);
    const Vec3<double> u = random.vector(1), t = random.vector(1), v = random.vector(1),
                       w = random.vector(1);
    for (std::size_t k = 0; k < 3; ++k) r[k] += size * u[k];
    test::put_rotation(state, b, product(exp_rotation(size * t), rotation(from, b)));
    if (!with_velocities) continue;
    for (std::size_t k = 0; k < 3; ++k) r[7 + k] += size * v[k], r[10 + k] += size * w[k];
  }
  return state;
}

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double largest = 0;
  for (std::size_t k = 0; k < a.size(); ++k) largest = std::max(largest, std::abs(a[k] - b[k]));
  return largest;
}

/// Vertices at the surface make kinks, which have no derivative.
bool near_a_kink(const Part& part, const State<Spatial>& state, std::size_t b, double reach) {
  for (std::int32_t v = part.shapes.vertex_of[b]; v < part.shapes.vertex_of[b + 1]; ++v) {
    const auto [w, x, y, z] = part.bodies.orientation[b];
    const Vec3<double> r = rotate(product(rotation(state, b), Quat<double>{w, x, y, z}),
                                  part.shapes.vertices[static_cast<std::size_t>(v)]);
    if (std::abs(part.bodies.position[b].z + state.record(b)[2] + r.z) < reach) return true;
  }
  return false;
}

class SharedWater : public testing::Test {
 protected:
  Lattice lattice = test::sheet(9, 8.5, 1.5, true);
  Part part = partition(lattice, PETSC_COMM_SELF);
};

TEST_F(SharedWater, IsWhatEachForceFindsAlone) {
  const State<Spatial> state = tumbled(part, 3);
  for (const DragOptions& options : {on_plan(), on_faces()}) {
    Water water(part, 1, options);
    const auto alone_buoyancy = make_buoyancy<Spatial>(part, weight);
    const auto alone_drag =
        options.faces ? make_face_drag(part, options, 9.81, {}) : make_drag<Spatial>(part, options);
    std::vector<double> alone = test::wrenches_of(*alone_buoyancy, state);
    const std::vector<double> other = test::wrenches_of(*alone_drag, state);
    alone.insert(alone.end(), other.begin(), other.end());
    EXPECT_EQ(water.in_step(state), alone);
    EXPECT_EQ(water.alone(state), alone);
    // Nothing of a state is left for another one.
    const State<Spatial> next = moved(state, part, 0.1, true);
    std::vector<double> after = test::wrenches_of(*alone_buoyancy, next);
    const std::vector<double> other_after = test::wrenches_of(*alone_drag, next);
    after.insert(after.end(), other_after.begin(), other_after.end());
    EXPECT_EQ(water.alone(next), after);
    EXPECT_EQ(water.in_step(next), after);
  }
}

TEST_F(SharedWater, APaceFollowsToTheSecondOrder) {
  const State<Spatial> state = tumbled(part, 3);
  for (const DragOptions& options : {on_plan(), on_faces()}) {
    Water each(part, 1, options), exact(part, 10, options);
    std::array<double, 2> error{};
    for (std::size_t k = 0; k < error.size(); ++k) {
      Water fresh(part, 10, options);
      EXPECT_EQ(fresh.in_step(state), fresh.alone(state));  // the first step computes
      EXPECT_LT(largest_difference(fresh.in_step(state), each.in_step(state)), 1e-9);
      fresh.submersion->commit(state, 1);
      const State<Spatial> next = moved(state, part, k == 0 ? 4e-4 : 2e-4, true);
      const std::vector<double> held = fresh.in_step(next), wanted = exact.alone(next);
      const auto bodies = static_cast<std::size_t>(part.owned);
      for (std::size_t b = 0; b < bodies; ++b) {
        if (near_a_kink(part, state, b, 2e-3)) continue;
        for (std::size_t n = 0; n < 6; ++n) {
          for (const std::size_t at : {b * 6 + n, (bodies + b) * 6 + n})
            error[k] = std::max(error[k], std::abs(held[at] - wanted[at]));
        }
      }
      EXPECT_NE(held, wanted);
      // The search for the stable step sees the forces themselves, and leaves the steps alone.
      EXPECT_EQ(fresh.alone(next), exact.alone(next));
      EXPECT_EQ(fresh.in_step(next), held);
      EXPECT_EQ(fresh.in_step(next), held);
    }
    EXPECT_LT(error[0], options.faces ? 1 : 0.02);  // of forces of some 1e4 N, changed by 10 N
    if (options.faces) {
      // Drag on faces follows velocities, not places.
      EXPECT_NEAR(error[0] / error[1], 2, 0.3);
    } else {
      EXPECT_NEAR(error[0] / error[1], 4, 0.4);
    }
  }
}

/// Drag on faces at other velocities, at the same place: forces of form, for which the rule of
/// three points is exact whatever u.n = 0 cuts off. Moments and friction have its error, which
/// changes.
TEST_F(SharedWater, FacesFollowVelocitiesToTheSecondOrder) {
  const State<Spatial> state = tumbled(part, 5);
  DragOptions options = on_faces();
  options.skin = 0;
  std::array<double, 2> error{};
  for (std::size_t k = 0; k < error.size(); ++k) {
    Water water(part, 10, options);
    (void)water.in_step(state);
    water.submersion->commit(state, 1);
    State<Spatial> next = state;
    test::Random random(2);
    const double size = k == 0 ? 2e-3 : 1e-3;
    for (std::size_t b = 0; b < static_cast<std::size_t>(part.owned); ++b) {
      const Vec3<double> v = random.vector(size), w = random.vector(size);
      for (std::size_t n = 0; n < 3; ++n) {
        next.record(b)[7 + n] += v[n];
        next.record(b)[10 + n] += w[n];
      }
    }
    const std::vector<double> held = water.in_step(next), wanted = water.alone(next);
    EXPECT_LT(largest_difference(held, wanted), 5e-2);
    for (std::size_t n = 0; n < held.size(); ++n)
      if (n % 6 < 3) error[k] = std::max(error[k], std::abs(held[n] - wanted[n]));
  }
  EXPECT_LT(error[0], 1e-2);
  EXPECT_NEAR(error[0] / error[1], 4, 0.4);
}

TEST_F(SharedWater, ABodyThatHasMovedFarIsLookedAtAtOnce) {
  const State<Spatial> state = tumbled(part, 3);
  Water water(part, 10, on_faces());
  (void)water.in_step(state);
  water.submersion->commit(state, 1);
  // Every second body by more than 1 % of its thickness of 0.5 m.
  State<Spatial> next = state;
  for (std::size_t b = 0; b < static_cast<std::size_t>(part.owned); b += 2)
    next.record(b)[2] += 8e-3;
  const std::vector<double> held = water.in_step(next), wanted = water.alone(next);
  EXPECT_EQ(held, wanted);  // others have not moved at all
  for (std::size_t b = 0; b < static_cast<std::size_t>(part.owned); ++b)
    EXPECT_EQ(water.submersion->is_new(b), b % 2 == 0) << b;
  // By less than that: followed.
  State<Spatial> near = next;
  for (std::size_t b = 0; b < static_cast<std::size_t>(part.owned); ++b) near.record(b)[2] += 1e-3;
  EXPECT_NE(water.in_step(near), water.alone(near));
  // And every tenth step all are looked at.
  for (int step = 1; step < 10; ++step) {
    EXPECT_FALSE(water.in_step(near) == water.alone(near)) << step;
    water.submersion->commit(near, 1);
  }
  EXPECT_EQ(water.in_step(near), water.alone(near));
}

/// At a pace wholly wet bodies are not clipped: their volume has the same bits everywhere.
TEST_F(SharedWater, WetAndDryBodiesAreNotClipped) {
  const Immersion immersion(part, Wet::by_points);
  test::Random random(9);
  int wet = 0, dry = 0;
  for (int trial = 0; trial < 100; ++trial) {
    State<Spatial> state(static_cast<std::size_t>(part.local));
    for (std::int32_t body = 0; body < part.owned; ++body) {
      const auto b = static_cast<std::size_t>(body);
      state.record(b)[2] = random.uniform(-0.9, 0.9);  // within the sphere of the corners
      test::put_rotation(state, b, random.rotation(1.5));
      const Submerged s = immersion.of(state, body), clipped = immersion.by_clipping(state, body);
      EXPECT_NEAR(s.volume, clipped.volume, 1e-14);
      if (clipped.waterplane > 0) continue;
      EXPECT_EQ(s.volume, clipped.volume > 0 ? immersion.volume(body) : 0.0);
      EXPECT_EQ(s.waterplane, 0);
      (clipped.volume > 0 ? wet : dry) += 1;
    }
  }
  EXPECT_GT(wet, 100);
  EXPECT_GT(dry, 20);
}

/// What waves do later and elsewhere, against differences.
TEST(WavesThatFollow, ChangeAsTheyDo) {
  const Lattice lattice = test::box({1, 1, 1}, 900, 0, {});
  const Part part = partition(lattice, PETSC_COMM_SELF);
  WaveOptions options{.spectrum = WaveOptions::Spectrum::jonswap, .height = 1, .period = 9};
  options.direction = 0.7, options.ramp = 20;
  const Waves waves(part, 9.81, options, {{0.1, 0.2, 0}, {}, {}});
  const double d = 1e-4;
  for (const double t : {3.0, 19.0, 40.0}) {
    const Vec3<double> at{3, -8, 0.2};
    const Waves::Change change = waves.change(0, at, t);
    const SurfacePlane a = waves.plane(0, at, t - d), b = waves.plane(0, at, t + d);
    EXPECT_NEAR(change.level, (b.level - a.level) / (2 * d), 1e-7);
    EXPECT_NEAR(change.slope_x, (b.slope_x - a.slope_x) / (2 * d), 1e-7);
    EXPECT_NEAR(change.slope_y, (b.slope_y - a.slope_y) / (2 * d), 1e-7);
    const SurfacePlane w = waves.plane(0, {at.x - d, at.y, 0}, t),
                       e = waves.plane(0, {at.x + d, at.y, 0}, t),
                       n = waves.plane(0, {at.x, at.y + d, 0}, t),
                       s = waves.plane(0, {at.x, at.y - d, 0}, t);
    EXPECT_NEAR(change.xx, (e.slope_x - w.slope_x) / (2 * d), 1e-7);
    EXPECT_NEAR(change.xy, (n.slope_x - s.slope_x) / (2 * d), 1e-7);
    EXPECT_NEAR(change.yy, (n.slope_y - s.slope_y) / (2 * d), 1e-7);
    const Vec3<double> rate =
        (1 / (2 * d)) * (waves.velocity(0, at, t + d) - waves.velocity(0, at, t - d));
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(change.velocity[k], rate[k], 1e-6);
  }
}

}  // namespace
}  // namespace floe
