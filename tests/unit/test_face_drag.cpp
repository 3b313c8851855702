// Drag on the wetted faces of bodies: the law by hand, what is sheltered, its derivatives, its
// decays and the book of its energy.

#include <gtest/gtest.h>

#include <cmath>

#include "support/blocks.h"
#include "support/box.h"
#include "support/dynamics.h"
#include "support/force_checks.h"
#include "support/lattices.h"
#include "support/roles.h"
#include "water/drag.h"

namespace floe {
namespace {

constexpr double rho = 1000;

DragOptions faces(double form, double skin, double shelter = 0) {
  return {.density = rho, .faces = true, .form = form, .skin = skin, .shelter = shelter};
}

std::unique_ptr<Force<Spatial>> drag_of(const Part& part, const DragOptions& options) {
  return make_face_drag(part, options, 9.81, {});
}

/// One box under water that moves, and the wrench on it.
std::vector<double> wrench_on(const Point3& sides, const Vec3<double>& velocity,
                              const Vec3<double>& spin, const DragOptions& options,
                              double height = -50) {
  const Lattice lattice = test::box(sides, 920, height, velocity, spin);
  const Part part = partition(lattice, PETSC_COMM_SELF);
  State<Spatial> state(1);
  double* r = state.record(0) + Spatial::velocity;
  r[0] = velocity.x, r[1] = velocity.y, r[2] = velocity.z;
  r[3] = spin.x, r[4] = spin.y, r[5] = spin.z;
  return test::wrenches_of(*drag_of(part, options), state);
}

/// A plate of 4 x 3 x 0.2 m. Broadside its front has 12 m^2 and its sides feel the flow along them;
/// edgewise the front has 0.6 m^2 and both large faces and two sides are along the flow.
TEST(FaceDrag, APlateIsTowedBroadsideAndEdgewise) {
  const double form = 0.5 * rho * 1.1, skin = 0.5 * rho * 0.004, v = 0.7;
  const DragOptions options = faces(1.1, 0.004);
  const auto broadside = wrench_on({4, 3, 0.2}, {0, 0, v}, {}, options);
  EXPECT_NEAR(broadside[2], -v * v * (form * 12 + skin * 2 * (4 + 3) * 0.2), 1e-9);
  const auto edgewise = wrench_on({4, 3, 0.2}, {v, 0, 0}, {}, options);
  EXPECT_NEAR(edgewise[0], -v * v * (form * 0.6 + skin * 2 * 4 * (3 + 0.2)), 1e-10);
  for (const auto& w : {broadside, edgewise})
    for (std::size_t k = 3; k < 6; ++k) EXPECT_NEAR(w[k], 0, 1e-10);
  // Half out of the water: half of the sides, all of the bottom.
  const auto half = wrench_on({4, 3, 0.2}, {v, 0, 0}, {}, options, 0);
  EXPECT_NEAR(half[0], -v * v * (form * 0.3 + skin * (12 + 4 * 0.2)), 1e-10);
  // Its force is below the centroid, at half the draft; skin has two sides and the bottom.
  EXPECT_NEAR(half[4], -v * v * (form * 0.3 * -0.05 + skin * (4 * 0.2 * -0.05 + 12 * -0.1)), 1e-10);
  // With the current nothing acts; a current against it is as a motion.
  DragOptions current = options;
  current.current = {v, 0, 0};
  for (const double w : wrench_on({4, 3, 0.2}, {v, 0, 0}, {}, current)) EXPECT_NEAR(w, 0, 1e-12);
  EXPECT_NEAR(wrench_on({4, 3, 0.2}, {}, {}, current)[0], -edgewise[0], 1e-10);
}

/// A prism of side a and draft d turns about its axis: half of each side moves against the water,
/// rho C_d/2 d (a^4/16) w^2 in all; a moment about x of a prism of side a and length L likewise.
TEST(FaceDrag, TurningIsResisted) {
  const double a = 2, d = 0.6, w = 0.3;
  const double yaw = 0.5 * rho * 1.1 * d * std::pow(a, 4) / 16 * w * w;
  for (const double sign : {1.0, -1.0}) {
    const auto about_z = wrench_on({a, a, d}, {}, {0, 0, sign * w}, faces(1.1, 0));
    EXPECT_NEAR(about_z[5], -sign * yaw, 1e-12 * yaw);
    // Pitch and roll: the four faces that are parallel to the axis.
    const auto about_x = wrench_on({d, a, a}, {}, {sign * w, 0, 0}, faces(1.1, 0));
    EXPECT_NEAR(about_x[3], -sign * yaw, 1e-12 * yaw);
    const auto about_y = wrench_on({a, d, a}, {}, {0, sign * w, 0}, faces(1.1, 0));
    EXPECT_NEAR(about_y[4], -sign * yaw, 1e-12 * yaw);
    for (const auto& wrench : {about_x, about_y, about_z})
      for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(wrench[k], 0, 1e-10);
  }
  // Skin on the end faces: 2 x rho C_s/2 w^2 int r^3 dA; on the sides, where the velocity along
  // them is w a/2: 4 d a (w a/2)^2 (a/2) rho C_s/2. int r^3 over the square of side 2 is
  // 8/5 int_0^(pi/4) sec^5 = 8/5 (7 sqrt(2) + 3 asinh(1))/8.
  const double square = (7 * std::sqrt(2.0) + 3 * std::asinh(1.0)) / 5;
  // The rule of the second degree on the two triangles of a square has r^2 = 5/9, 5/9 and 8/9.
  const double by_rule = 4 * (2 * std::pow(5.0 / 9, 1.5) + std::pow(8.0 / 9, 1.5)) / 3;
  EXPECT_NEAR(by_rule / square, 0.886, 1e-3);
  const double skin = 0.5 * rho * 0.01 * w * w * (2 * by_rule + 4 * d * a * std::pow(a / 2, 3));
  const auto along = wrench_on({a, a, d}, {}, {0, 0, w}, faces(0, 0.01));
  EXPECT_NEAR(along[5] / -skin, 1, 1e-12);
}

/// I w' = -k w^2: 1/w grows by k t/I.
TEST(FaceDrag, YawAndPitchDecay) {
  const double a = 2, w0 = 1;
  for (const std::size_t axis : {2, 0}) {
    const double d = 0.9;
    const Point3 sides = axis == 2 ? Point3{a, a, d} : Point3{d, a, a};
    Point3 spin{0, 0, 0};
    spin[axis] = w0;
    const Lattice lattice = test::box(sides, 920, -50, {0, 0, 0}, spin);
    Scene scene;
    scene.forces.drag = true;
    scene.drag = faces(1.1, 0);
    test::Dynamics run(scene, lattice);
    const double dt = 1e-3;
    run.set_step(dt);
    const double before = run.kinetic();
    run.steps(20000);
    const double k = 0.5 * rho * 1.1 * d * std::pow(a, 4) / 16;
    const double inertia = lattice.bodies.inertia[0][axis];
    const double expected = w0 / (1 + k * w0 / inertia * (20 - 0.5 * dt));
    EXPECT_NEAR(angular_velocity(run.state(), 0)[axis] / expected, 1, 1e-4);
    EXPECT_LT(expected, 0.4);
    EXPECT_NEAR((run.kinetic() + run.reported("energy_drag")) / before, 1, 1e-10);
  }
}

/// A disc of 32 sides, denser than water, sinks flat: sqrt(2 (rho - rho_w) g h/(rho_w C_d)).
TEST(FaceDrag, ADiscSinksAtItsTerminalSpeed) {
  Lattice lattice;
  std::vector<Point2> plan;
  for (int k = 0; k < 32; ++k)
    plan.push_back({std::cos(2 * M_PI * k / 32), std::sin(2 * M_PI * k / 32)});
  const double h = 0.2, density = 1500;
  append_prism(lattice.shapes, plan, -h / 2, h / 2);
  const PlanProperties p = plan_properties(plan);
  const double mass = density * p.area * h, slab = mass * h * h / 12;
  test::append_block_body(
      lattice, {0, 0, -5}, {1, 0, 0, 0}, mass,
      {density * h * p.xx + slab, density * h * p.yy + slab, density * h * (p.xx + p.yy)}, {}, {});
  Scene scene;
  scene.forces.gravity = scene.forces.buoyancy = scene.forces.drag = true;
  scene.water_density = rho;
  scene.drag = faces(1.1, 0);
  test::Dynamics run(scene, lattice);
  run.set_step(1e-3);
  run.steps(8000);
  const double terminal = std::sqrt(2 * (density - rho) * 9.81 * h / (rho * 1.1));
  EXPECT_NEAR(velocity(run.state(), 0).z / -terminal, 1, 1e-6);
}

/// A tilted box that floats, moves and turns, half of it out of the water.
struct Tumbling {
  Lattice lattice = test::box({2, 1.4, 0.8}, 920, 0.1, {0.4, -0.3, 0.2}, {0.3, -0.5, 0.7});
  Part part = partition(lattice, PETSC_COMM_SELF);
  State<Spatial> state{1};
  Tumbling() {
    test::put_rotation(state, 0, exp_rotation({0.3, -0.2, 0.5}));
    double* r = state.record(0) + Spatial::velocity;
    for (const double v : {0.4, -0.3, 0.2, 0.3, -0.5, 0.7}) *r++ = v;
  }
};

/// Where the line u.n = 0 crosses a face the points of the quadrature move with it, which the
/// derivative leaves out: its error is that of the quadrature.
TEST(FaceDrag, DampingIsTheDerivative) {
  for (const bool crosses : {false, true}) {
    Tumbling m;
    if (!crosses) {
      for (int k = 3; k < 6; ++k) m.state.record(0)[Spatial::velocity + k] *= 0.03;
    }
    DragOptions options = faces(1.1, 0.1);
    options.linear = 50;
    options.current = {0.2, 0.1, -0.3};
    const auto drag = drag_of(m.part, options);
    const std::vector<std::uint8_t> held(1, 0);
    Tangent<Spatial> tangent(m.part, held, 1.0, 0.0, {MATAIJ, false});
    tangent.begin();
    add_damping(*drag, m.state, tangent);
    tangent.end();
    const test::Dense c = test::dense(tangent.matrix());
    EXPECT_LT((c - c.transpose()).norm(), 1e-12 * c.norm());
    double trace = 0;
    for (Eigen::Index k = 0; k < 6; ++k) {
      const auto values = [&](double amount) {
        State<Spatial> moved = m.state;
        moved.record(0)[static_cast<Eigen::Index>(Spatial::velocity) + k] += amount;
        return test::wrenches_of(*drag, moved);
      };
      const std::vector<double> slope = test::derivative<double>(values, 1e-3);
      for (Eigen::Index r = 0; r < 6; ++r)
        EXPECT_NEAR(c(r, k), -slope[static_cast<std::size_t>(r)],
                    (crosses ? 3e-3 : 1e-8) * c.norm());
      trace += c(k, k) / (k < 3 ? m.lattice.bodies.mass[0] : m.lattice.bodies.inertia[0][k - 3]);
    }
    // The estimate of the rate is a bound of C/M.
    const double rate = rate_estimate(*drag, m.state).value();
    EXPECT_GT(rate, trace / 6);
    EXPECT_LT(rate, 30 * trace);
  }
}

/// The power that is lost is that of the wrench, with the velocity and with the spin.
TEST(FaceDrag, LosesItsPower) {
  Tumbling m;
  const auto drag = drag_of(m.part, faces(1.1, 0.1));
  const std::vector<double> w = test::wrenches_of(*drag, m.state);
  double power = 0;
  for (std::size_t k = 0; k < 6; ++k) power += w[k] * m.state.record(0)[Spatial::velocity + k];
  EXPECT_NEAR(powers(*drag)[0], power, 1e-12 * std::abs(power));
  EXPECT_LT(power, 0);
}

/// A sheet's inner sides are joined by beams: moving along x it feels the water at its edge and,
/// along them, on bottom and sides only.
TEST(FaceDrag, ASheetIsOneBody) {
  Lattice lattice = test::sheet(6, 5, 1.2, true);
  for (auto& p : lattice.bodies.position) p.z -= 10;
  const double h = 0.5;  // of test::sheet
  const auto total = [&](const Lattice& of, double shelter) {
    const Part part = partition(of, PETSC_COMM_SELF);
    State<Spatial> state(static_cast<std::size_t>(part.local));
    for (std::int32_t b = 0; b < part.owned; ++b)
      state.record(static_cast<std::size_t>(b))[Spatial::velocity] = 1;
    const std::vector<double> w =
        test::wrenches_of(*drag_of(part, faces(1.1, 0.004, shelter)), state);
    double sum = 0;
    for (std::size_t b = 0; b < w.size(); b += 6) sum += w[b];
    return sum;
  };
  const double whole = 0.5 * rho * (1.1 * 5 * h + 0.004 * 2 * 6 * (5 + h));
  EXPECT_NEAR(total(lattice, 0) / -whole, 1, 1e-9);
  // Without beams each cell has a front of its own, unless its neighbours shelter it.
  lattice.beams = {};
  EXPECT_LT(total(lattice, 0), -2 * whole);
  EXPECT_NEAR(total(lattice, 1e-3) / -whole, 1, 1e-9);
}

/// Two blocks: a gap narrower than the shelter hides the faces on it; where the blocks part, the
/// faces are found anew.
TEST(FaceDrag, ShelterEndsWhereBodiesPart) {
  Lattice lattice;
  test::append_block(lattice, {1, 1, 1}, {0, 0, -20}, {1, 0, 0, 0}, {-0.5, 0, 0});
  test::append_block(lattice, {1, 1, 1}, {1.1, 0, -20}, {1, 0, 0, 0}, {-0.5, 0, 0});
  Scene scene;
  scene.forces.drag = true;
  scene.drag = faces(1, 0, 0.3);
  test::Dynamics run(scene, lattice);
  run.set_step(1e-3);
  const double front = 0.5 * rho;
  const auto force = [&](std::size_t b) {
    const double v = velocity(run.state(), b).x;
    return run.wrenches().of(b)[0] / (front * v * v);
  };
  EXPECT_NEAR(force(0), 1, 1e-9);
  EXPECT_EQ(force(1), 0);
  while (displacement(run.state(), 1).x - displacement(run.state(), 0).x > -0.05) run.steps(1);
  // The second is not slowed down and catches up: pushed back by hand it feels the flow.
  run.state().record(1)[0] += 0.4;
  run.steps(200);
  EXPECT_NEAR(force(1), 1, 1e-9);
}

}  // namespace
}  // namespace floe
