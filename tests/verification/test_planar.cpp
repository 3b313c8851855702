// Planar runs are spatial ones: statics to 1e-12, dynamics to 1e-9, beams' forces to 1e-9; and a
// linear scene is one factorisation.
#include <algorithm>
#include <cmath>

#include "stability/stable_step.h"
#include "support/dynamics.h"
#include "support/record.h"
#include "support/tension.h"

namespace floe::test {
namespace {

constexpr const char* section_name = "Planar models";

/// Differences of a planar solution from a spatial one over the largest value.
struct Difference {
  double displacement = 0, rotation = 0, reaction = 0, beams = 0, out_of_plane = 0;
};

Difference difference(const Model<Planar>& planar, const State<Planar>& p,
                      const Wrenches<Planar>& wp, const Model<Spatial>& spatial,
                      const State<Spatial>& s, const Wrenches<Spatial>& ws) {
  struct {
    double u = 0, turn = 0, force = 0, beam = 0;
  } size;
  Difference d;
  const bool linear = spatial.kinematics() == Kinematics::linear;
  for (std::size_t b = 0; b < static_cast<std::size_t>(planar.part().owned); ++b) {
    const Vec3<double> u = displacement(s, b), away = displacement(p, b) - u;
    const Vec3<double> t = linear ? linear_rotation(s, b) : log_rotation(rotation(s, b));
    size.u = std::max(size.u, std::sqrt(dot(u, u)));
    size.turn = std::max(size.turn, std::abs(t.z));
    d.displacement = std::max(d.displacement, std::sqrt(dot(away, away)));
    d.rotation = std::max(d.rotation, std::abs(linear_rotation(p, b).z - t.z));
    d.out_of_plane = std::max({d.out_of_plane, std::abs(u.z), std::abs(t.x), std::abs(t.y)});
    const auto f = components_of(wp, b), g = components_of(ws, b);
    for (const std::size_t k : {0U, 1U, 5U}) {
      size.force = std::max(size.force, std::abs(g[k]));
      d.reaction = std::max(d.reaction, std::abs(f[k] - g[k]));
    }
  }
  const auto a = planar.beams()->sections(p), c = spatial.beams()->sections(s);
  for (std::size_t m = 0; m < a.size(); ++m) {
    for (std::size_t k = 0; k < 3; ++k) {  // moments too, over the length scale
      const double length = planar.length_scale();
      size.beam = std::max({size.beam, std::abs(c[m][k]), std::abs(c[m][3 + k]) / length});
      d.beams = std::max(
          {d.beams, std::abs(a[m][k] - c[m][k]), std::abs(a[m][3 + k] - c[m][3 + k]) / length});
    }
  }
  d.displacement /= size.u, d.rotation /= size.turn, d.reaction /= size.force;
  d.beams /= size.beam;
  return d;
}

/// Stretched, sheared by a load on one side, one corner turned.
Scene loaded(Kinematics kinematics) {
  Scene scene = tension_scene(20, 0.5, 1.5, 2);
  scene.beam.kinematics = kinematics;
  scene.boundaries[0].fixed[1] = scene.boundaries[0].fixed[5] = true;
  Load side;
  side.name = "side", side.set = "top", side.force = {3e5, -2e5, 0}, side.moment = {0, 0, 1e5};
  side.ramp.seconds = 1;
  Load point;
  point.name = "point", point.point = Point2{3, -2}, point.force = {-1e5, 2e5, 0};
  point.ramp.seconds = 0.5;
  scene.loads = {side, point};
  scene.time.dt = 0.25;
  return scene;
}

TEST(Planar, StaticsAreThoseOfSpace) {
  struct Case {
    const char* name;
    Scene scene;
  };
  for (const auto& [name, scene] : {Case{"tension", tension_scene(40, 1, 2, 1)},
                                    Case{"tension of 1e-9", tension_scene(40, 1, 2, 1, 1e-9)},
                                    Case{"loaded, turned", loaded(Kinematics::corotational)},
                                    Case{"loaded, linear", loaded(Kinematics::linear)}}) {
    Lattice lattice = mesh_of(scene);
    const auto planar = solve_static<Planar>(scene, lattice);
    const auto spatial = solve_static<Spatial>(scene, lattice);
    ASSERT_EQ(planar.states.size(), spatial.states.size());
    EXPECT_EQ(planar.result.newton_iterations, spatial.result.newton_iterations) << name;
    EXPECT_EQ(planar.result.unstable_modes, 0) << name;
    const Difference d = difference(*planar.model, planar.last(), planar.wrenches, *spatial.model,
                                    spatial.last(), spatial.wrenches);
    EXPECT_EQ(d.out_of_plane, 0) << name;
    for (const auto& [quantity, value, tolerance] :
         {std::tuple{"displacements", d.displacement, 1e-12},
          {"rotations", d.rotation, 1e-9},
          {"beams' forces", d.beams, 1e-9}}) {
      verify({.section = section_name,
              .quantity = text("statics, %s: %s against the spatial model", name, quantity),
              .value = value,
              .reference = 0.0,
              .tolerance = tolerance});
    }
    if (!scene.loads.empty()) continue;
    double planar_force = 0, force = 0;
    for (const std::int32_t body : lattice.sets.at("left")) {
      planar_force += planar.wrenches.of(static_cast<std::size_t>(body))[0];
      force += spatial.wrenches.of(static_cast<std::size_t>(body))[0];
    }
    verify({.section = section_name,
            .quantity = text("statics, %s: E over that of the spatial model, less 1", name),
            .value = planar_force / force - 1,
            .reference = 0.0,
            .tolerance = 1e-12});
  }
}

/// A strip that a load compresses: `part` of Euler's load of a column, hinged where it is pushed.
Scene column(double part) {
  Scene scene;
  scene.has_sheet = true;
  scene.sheet = {60, 3, 1.5, 4, Relaxation::lloyd, 50, 0};
  scene.thickness = 0.5;
  scene.forces.beam = true;
  Boundary root;
  root.name = root.set = "left", root.fixed.fill(true), root.velocity = Point3{};
  scene.boundaries = {root};
  // Clamped and free: pi^2 EI/(2 L)^2, with the lattice's bending stiffness near that of the ice.
  const double inertia = 3 * std::pow(scene.thickness, 3) / 12, length = 59;
  const double euler =
      std::pow(std::acos(-1.0), 2) * scene.ice.young * inertia / (4 * length * length);
  Load push;
  push.name = "push", push.set = "right", push.force = {-part * euler, 0, 0};
  push.ramp.seconds = 1;
  scene.loads = {push};
  return scene;
}

/// A planar model cannot buckle upwards, but it knows that the spatial one would.
TEST(Planar, KnowsOfBucklingOutOfPlane) {
  for (const auto& [part, stable] : {std::pair{0.5, true}, {2.0, false}, {12.0, false}}) {
    const Scene scene = column(part);
    const Lattice lattice = mesh_of(scene);
    const auto planar = solve_static<Planar>(scene, lattice);
    const auto spatial = solve_static<Spatial>(scene, lattice);
    EXPECT_EQ(planar.result.unstable_modes, spatial.result.unstable_modes) << part;
    EXPECT_EQ(planar.result.unstable_modes == 0, stable) << part;
  }
}

TEST(Linear, ASceneIsOneFactorisationAndOneSolveAStep) {
  for (const bool planar : {true, false}) {
    Scene scene = loaded(Kinematics::linear);
    scene.time.dt = 0.125;
    const Lattice lattice = mesh_of(scene);
    const RunResult result = planar ? solve_static<Planar>(scene, lattice).result
                                    : solve_static<Spatial>(scene, lattice).result;
    EXPECT_EQ(result.steps, 8);
    EXPECT_EQ(result.newton_iterations, 8) << "one solve for each";
    EXPECT_EQ(result.factorisations, 1);
    EXPECT_EQ(result.unstable_modes, 0);
  }
}

/// The answer is that of one step, and of twice the load half.
TEST(Linear, StepsAddUp) {
  Scene scene = loaded(Kinematics::linear);
  const Lattice lattice = mesh_of(scene);
  scene.time.dt = 0.125;
  const auto many = solve_static<Planar>(scene, lattice);
  scene.time.dt = 1;
  const auto one = solve_static<Planar>(scene, lattice);
  double size = 0, difference = 0;
  for (std::size_t k = 0; k < one.last().records.size(); ++k) {
    size = std::max(size, std::abs(one.last().records[k]));
    difference = std::max(difference, std::abs(one.last().records[k] - many.last().records[k]));
  }
  EXPECT_GT(size, 1e-4);
  EXPECT_LT(difference, 1e-12 * size);
}

/// Floating bodies turn their buoyancy with them: not linear, whatever the beams.
TEST(Linear, WithBuoyancyItIsNot) {
  Scene scene = tension_scene(6, 0.5, 1, 1);
  scene.boundaries.clear();
  scene.beam.kinematics = Kinematics::linear;
  scene.forces.gravity = scene.forces.buoyancy = true;
  Load load;
  load.name = "p", load.point = Point2{0, 0}, load.force = {0, 0, -1e4}, load.ramp.seconds = 1;
  scene.loads = {load};
  scene.time.dt = 0.5;
  const auto floating = solve_static(scene, mesh_of(scene));
  EXPECT_GT(floating.result.factorisations, 1);
}

/// Held on the left, pulled on the right by a velocity, pushed and turned elsewhere, in flowing
/// water. With linear kinematics all of it three hundredths: spatial dynamics take 2 sin(theta/2)
/// for an angle theta there, planar ones the angle; and they round rotations by 1e-16 per step,
/// which the work of a small rotation shows.
double size_of(Kinematics kinematics) { return kinematics == Kinematics::linear ? 0.03 : 1; }
Scene moving(Kinematics kinematics, double damping) {
  const double size = size_of(kinematics);
  Scene scene = tension_scene(12, 0.5, 1, 5);
  scene.integrator = Integrator::explicit_;
  scene.beam.kinematics = kinematics;
  scene.beam.damping_ratio = damping;
  scene.forces.drag = true;
  scene.drag = {2e4, 1, 1010, {0.2 * size, -0.1 * size, 0}};
  scene.boundaries[0].fixed = {true, true, true, true, true, true};
  scene.boundaries[0].velocity = Point3{};
  scene.boundaries[1].displacement.reset();
  scene.boundaries[1].velocity = Point3{0.3 * size, 0, 0};
  scene.boundaries[1].fixed[5] = true;
  scene.boundaries[1].angular_velocity = {0, 0, 0.02 * size};
  scene.boundaries[1].ramp.seconds = 0.01;
  Load point;
  point.name = "point", point.point = Point2{3, -2}, point.force = {-1e6 * size, 2e6 * size, 0};
  scene.loads = {point};
  return scene;
}

TEST(Planar, DynamicsAreThoseOfSpace) {
  for (const Kinematics kinematics : {Kinematics::corotational, Kinematics::linear}) {
    const double size = size_of(kinematics);
    for (const double damping : {0.0, 0.5}) {
      const Scene scene = moving(kinematics, damping);
      Lattice lattice = mesh_of(scene);
      lattice.bodies.velocity.assign(lattice.bodies.mass.size(),
                                     Point3{0.1 * size, 0.05 * size, 0});
      lattice.bodies.angular_velocity.assign(lattice.bodies.mass.size(), Point3{0, 0, 0.01 * size});
      DynamicsIn<Planar> planar(scene, lattice);
      DynamicsIn<Spatial> spatial(scene, lattice);
      planar.set_step(2e-5);
      spatial.set_step(2e-5);
      planar.steps(2000);
      spatial.steps(2000);
      const Difference d = difference(planar.model(), planar.state(), planar.wrenches(),
                                      spatial.model(), spatial.state(), spatial.wrenches());
      EXPECT_EQ(d.out_of_plane, 0);
      const std::string name = name_of(kinematics) + (damping > 0 ? ", damped" : ", undamped");
      for (const auto& [quantity, value] :
           {std::pair{"displacements", d.displacement}, {"beams' forces", d.beams}}) {
        verify({.section = section_name,
                .quantity = text("dynamics, %s, 2000 steps: %s against the spatial model",
                                 name.c_str(), quantity),
                .value = value,
                .reference = 0.0,
                .tolerance = 1e-9});
      }
      EXPECT_NEAR(planar.kinetic() / spatial.kinetic(), 1, 1e-9);
      EXPECT_NEAR(planar.boundary_work() / spatial.boundary_work(), 1, 1e-9);
      for (const char* energy : {"energy_strain", "energy_external", "energy_drag"})
        EXPECT_NEAR(planar.reported(energy) / spatial.reported(energy), 1, 1e-9) << energy;
      EXPECT_NEAR(planar.reported("energy_damping"), spatial.reported("energy_damping"),
                  1e-9 * spatial.reported("energy_damping"));
      EXPECT_EQ(spatial.reported("energy_damping") > 0, damping > 0);
      const auto p = planar.momentum(), q = spatial.momentum();
      for (const std::size_t k : {0U, 1U, 5U}) EXPECT_NEAR(p[k] / q[k], 1, 1e-9) << k;
    }
  }
}

/// In the plane fewer modes limit the step, never more.
TEST(Planar, StableStepIsThatOfTheModesInPlane) {
  const Scene scene = tension_scene(12, 0.5, 1, 5);
  const Lattice lattice = mesh_of(scene);
  DynamicsIn<Planar> planar(scene, lattice);
  DynamicsIn<Spatial> spatial(scene, lattice);
  const StableStep in_plane = stable_step(planar.model(), planar.state()),
                   all = stable_step(spatial.model(), spatial.state());
  EXPECT_GE(in_plane.dt, all.dt * (1 - 1e-5));
  // All that is out of plane held, the spatial model has the planar one's modes.
  Scene held = scene;
  Boundary plane;
  plane.name = "plane", plane.set = "all", plane.fixed = {false, false, true, true, true, false};
  plane.velocity = Point3{};
  held.boundaries.push_back(plane);
  Lattice with_all = lattice;
  auto& all_bodies = with_all.sets["all"];
  all_bodies.resize(lattice.bodies.mass.size());
  for (std::size_t b = 0; b < all_bodies.size(); ++b) all_bodies[b] = static_cast<std::int32_t>(b);
  DynamicsIn<Spatial> flat(held, with_all);
  EXPECT_NEAR(stable_step(flat.model(), flat.state()).dt / in_plane.dt, 1, 1e-5);
}

/// A free floe that spins and vibrates keeps its momentum, and its energy to the step's order.
TEST(Planar, FreeFlightKeepsMomentumThroughManyTurns) {
  Scene scene = beams_only(Shear::one_point);
  Lattice lattice = mesh_of(tension_scene(6, 0.5, 1, 7));
  for (std::size_t b = 0; b < lattice.bodies.mass.size(); ++b) {
    const Point3& x = lattice.bodies.position[b];
    constexpr double spin = 40;  // [rad/s]
    lattice.bodies.velocity.push_back({3 - spin * x[1], spin * x[0], 0});
    lattice.bodies.angular_velocity.push_back({0, 0, spin});
  }
  DynamicsIn<Planar> run(scene, lattice);
  run.set_step(5e-5);
  const auto before = run.momentum();
  run.steps(20000);  // 6.4 turns
  const auto after = run.momentum();
  const double turn = run.state().record(0)[Planar::rotation];
  EXPECT_NEAR(turn, 40, 1);
  EXPECT_NEAR(after[0] / before[0], 1, 1e-11);
  EXPECT_NEAR(after[1], 0, 1e-11 * before[0]);
  EXPECT_NEAR(after[5] / before[5], 1, 1e-11);
}

}  // namespace
}  // namespace floe::test
