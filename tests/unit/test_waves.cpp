// Waves: their kinematics, the force on a body against the integral of the pressure, and what is
// refused.
#include "submersion/waves.h"

#include <gtest/gtest.h>

#include <cmath>

#include "submersion/immersion.h"
#include "support/blocks.h"
#include "support/box.h"
#include "support/dynamics.h"
#include "support/force_checks.h"
#include "support/roles.h"
#include "water/buoyancy.h"
#include "water/drag.h"

namespace floe {
namespace {

constexpr double g = 9.81, rho = 1000, pi = 3.14159265358979323846;

/// A regular wave of a given length in deep water.
WaveOptions of_length(double length, double height) {
  return {.height = height, .period = 2 * pi / std::sqrt(g * 2 * pi / length)};
}

TEST(Waves, Dispersion) {
  for (const double depth : {0.5, 3.0, 20.0, 1e4}) {
    for (const double omega : {0.05, 0.3, 1.0, 4.0}) {
      const double k = wave_number(omega, g, depth);
      EXPECT_NEAR(g * k * std::tanh(k * depth) / (omega * omega), 1, 1e-13) << depth << omega;
    }
  }
  // Shallow water: the speed is sqrt(g H).
  EXPECT_NEAR(0.01 / wave_number(0.01, g, 2) / std::sqrt(2 * g), 1, 1e-5);
}

/// The velocity is that of a potential flow: without divergence and rotation, vertical at the
/// surface as the surface moves; with a bottom, along it there.
TEST(Waves, VelocityIsThatOfTheSurface) {
  for (const double depth : {2.0, 1e9}) {
    Lattice lattice;
    test::append_block(lattice, {0.5, 0.5, 0.02}, {0, 0, 0.01});  // draft 0
    const Part part = partition(lattice, PETSC_COMM_SELF);
    WaveOptions options{.height = 0.2, .period = 3, .direction = 0.6, .phase = 0.4};
    options.depth = depth;
    const Waves waves(part, g, options, {{0.1, 0, 0}, {}, {}});
    const double omega = 2 * pi / 3, k = wave_number(omega, g, depth), t = 0.7, d = 1e-5;
    const Vec3<double> at{1.3, -0.4, 0};
    const SurfacePlane now = waves.plane(0, at, t);
    const double angle = k * (at.x * std::cos(0.6) + at.y * std::sin(0.6)) - omega * t + 0.4;
    EXPECT_NEAR(now.level, 0.1 * std::cos(angle), 1e-14);
    const auto level = [&](double x, double y, double time) {
      return waves.plane(0, {x, y, 0}, time).level;
    };
    EXPECT_NEAR(now.slope_x, (level(at.x + d, at.y, t) - level(at.x - d, at.y, t)) / (2 * d), 1e-8);
    EXPECT_NEAR(now.slope_y, (level(at.x, at.y + d, t) - level(at.x, at.y - d, t)) / (2 * d), 1e-8);
    const Vec3<double> v = waves.velocity(0, at, t);
    EXPECT_NEAR(v.z, (level(at.x, at.y, t + d) - level(at.x, at.y, t - d)) / (2 * d), 1e-8);
    // Bernoulli at the surface: d v/d t = -g grad eta.
    const double rate = (waves.velocity(0, at, t + d).x - waves.velocity(0, at, t - d).x) / (2 * d);
    EXPECT_NEAR(rate, -g * now.slope_x, 1e-8);
  }
}

/// A JONSWAP sea has its significant height and its peak, and waves in the order of their
/// frequencies; another seed changes the phases only.
TEST(Waves, AJonswapSea) {
  WaveOptions options{.spectrum = WaveOptions::Spectrum::jonswap, .height = 2, .period = 8};
  options.components = 400;
  const auto sea = wave_components(options, g);
  ASSERT_EQ(sea.size(), 400U);
  double m0 = 0, m1 = 0;
  std::size_t near_peak = 0;
  for (const WaveComponent& w : sea) {
    m0 += w.amplitude * w.amplitude / 2;
    m1 += w.omega * w.amplitude * w.amplitude / 2;
    near_peak += std::abs(w.omega * 8 / (2 * pi) - 1) < 0.1 ? 1 : 0;
  }
  EXPECT_NEAR(4 * std::sqrt(m0), 2, 1e-12);
  // T_1/T_p = .8348 for gamma = 3.3 (DNV-RP-C205, 3.5.5: .7303 + .04936 gamma - .006556 gamma^2
  // + .000361 gamma^3). With S = x^-5 exp(-1.25 x^-4) gamma^r, x the frequency over the peak's, m_0
  // is .2/(1 - .287 ln gamma) (the same, 3.5.5.2); what is above x = 3, where S = x^-5, is left
  // out.
  const double t1 = 0.7303 + 0.04936 * 3.3 - 0.006556 * 3.3 * 3.3 + 0.000361 * std::pow(3.3, 3);
  const double whole0 = 0.2 / (1 - 0.287 * std::log(3.3)), whole1 = whole0 / t1;
  EXPECT_NEAR(2 * pi * m0 / m1 / 8, (whole0 - 1 / (4 * 81.0)) / (whole1 - 1 / (3 * 27.0)), 0.003);
  EXPECT_GT(near_peak, 100U);
  options.seed = 2;
  const auto other = wave_components(options, g);
  EXPECT_EQ(other[7].omega, sea[7].omega);
  EXPECT_NE(other[7].phase, sea[7].phase);
}

/// Vertical force of the wave on a box of side a and draft d with the pressure of the wave at its
/// bottom, integrated exactly: rho g A eta e^(-k d) sin(ka/2)/(ka/2), which over rho g A eta is
/// .53, .74 and .89 at lengths of 10, 20 and 50 m. The local plane leaves out the last factor.
TEST(Waves, HeaveForceOfABox) {
  const double a = 2, d = 0.9;
  const std::array<std::pair<double, double>, 3> cases{{{10, 0.53}, {20, 0.74}, {50, 0.89}}};
  for (const auto& [length, rounded] : cases) {
    const double k = 2 * pi / length, half = k * a / 2;
    const double exact = std::exp(-k * d) * std::sin(half) / half;
    EXPECT_NEAR(exact, rounded, 0.005);
    const Lattice lattice = test::box({a, a, 1}, 900, 0.5 - d, {});
    const Part part = partition(lattice, PETSC_COMM_SELF);
    const State<Spatial> state(1);
    const double height = 1e-3;
    const WaveOptions wave = of_length(length, height);
    if (length < 16) {
      EXPECT_THROW((void)make_buoyancy_in_waves(part, rho * g, g, wave), InputError);
      continue;
    }
    const auto buoyancy = make_buoyancy_in_waves(part, rho * g, g, wave);
    const double extra = test::wrenches_of(*buoyancy, state)[2] - rho * g * a * a * d;
    const double ratio = extra / (rho * g * a * a * height / 2);
    EXPECT_NEAR(ratio, std::exp(-k * d), 1e-6);
    EXPECT_NEAR(ratio / exact, 1, length == 20 ? 0.017 : 0.003);
  }
}

/// Without a slope it is buoyancy with the level moved; with one, the force is normal to the plane
/// and goes through the centroid of the part below it.
TEST(Waves, BuoyancyIsNormalToThePlane) {
  Lattice lattice = test::box({2, 1.5, 1}, 900, 0.1, {});
  const Part part = partition(lattice, PETSC_COMM_SELF);
  const Immersion immersion(part);
  State<Spatial> state(1);
  test::put_rotation(state, 0, exp_rotation({0.2, -0.1, 0.4}));
  const SurfacePlane plane{0.05, 0.12, -0.07};
  const Submerged s = immersion.below(state, 0, plane);
  // By clipping a body that is turned with the water.
  State<Spatial> turned = state;
  test::put_rotation(turned, 0, product(plane.to_level(), rotation(state, 0)));
  turned.record(0)[2] = (0.1 - 0.05) / plane.steepness() - 0.1;
  const Submerged clipped = immersion.by_clipping(turned, 0);
  EXPECT_NEAR(s.volume, clipped.volume, 1e-12);
  EXPECT_NEAR(length(s.moment - clipped.moment), 0, 1e-12);
  const Vec3<double> up = rotate(plane.to_level(), plane.normal());
  EXPECT_NEAR(up.x, 0, 1e-15);
  EXPECT_NEAR(up.y, 0, 1e-15);
  EXPECT_NEAR(up.z, 1, 1e-15);
  // Volume below the plane by points.
  const int n = 60;
  double volume = 0;
  const Triad<double> axes = triad(rotation(state, 0));
  Vec3<double> moment{0, 0, 0};
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      for (int l = 0; l < n; ++l) {
        const Vec3<double> r = axes.to_world(
            {2 * ((i + 0.5) / n - 0.5), 1.5 * ((j + 0.5) / n - 0.5), (l + 0.5) / n - 0.5});
        if (0.1 + r.z < 0.05 + 0.12 * r.x - 0.07 * r.y) volume += 1, moment = moment + r;
      }
  const double cell = 3.0 / (n * n * n);
  EXPECT_NEAR(cell * volume / s.volume, 1, 2e-3);
  const Vec3<double> back = rotate(conjugate(plane.to_level()), s.moment);
  EXPECT_NEAR(length(cell * moment - back), 0, 3e-3);
}

/// A light raft on a long wave goes up and down with it, and is pushed to and fro as a particle of
/// the water is; the book of energy closes.
TEST(Waves, ASmallFloeFollowsALongWave) {
  const double length = 60, height = 0.6;
  const Lattice lattice = test::box({2, 2, 0.2}, 500, 0, {});
  Scene scene;
  scene.forces.gravity = scene.forces.buoyancy = scene.forces.drag = true;
  scene.water_density = rho;
  scene.drag.density = rho;
  scene.drag.linear = 2000;
  scene.waves = of_length(length, height);
  scene.waves.ramp = 10;
  test::Dynamics run(scene, lattice);
  run.set_step(2e-3);
  run.steps(30000);
  const double k = 2 * pi / length, omega = std::sqrt(g * k);
  double highest = 0, fastest = 0, error = 0;
  for (int n = 0; n < 6000; ++n) {
    run.steps(1);
    const Vec3<double> u = displacement(run.state(), 0);
    const double eta = 0.3 * std::exp(-k * 0.1) * std::cos(k * u.x - omega * run.state().time);
    error = std::max(error, std::abs(u.z - eta));
    highest = std::max(highest, u.z);
    fastest = std::max(fastest, velocity(run.state(), 0).x);
  }
  EXPECT_NEAR(highest / 0.3, 1, 0.02);
  EXPECT_LT(error, 0.02 * 0.3);
  EXPECT_NEAR(fastest / (0.3 * omega), 1, 0.05);
  const double energy = run.kinetic() + run.reported("energy_gravity") +
                        run.reported("energy_drag") - run.reported("energy_external");
  EXPECT_NEAR(energy, 0, 1e-9 * (std::abs(run.reported("energy_external")) + 1));
}

/// Drag at centroids knows the velocity of the water in waves.
TEST(Waves, OrbitalVelocityDrags) {
  const Lattice lattice = test::box({2, 2, 1}, 900, -0.4, {});
  const Part part = partition(lattice, PETSC_COMM_SELF);
  State<Spatial> state(1);
  state.set_time(0.3);
  const WaveOptions wave = of_length(40, 0.4);
  const double k = 2 * pi / 40, omega = std::sqrt(g * k), decay = std::exp(-k * 0.45);
  const Vec3<double> u{0.2 * omega * decay * std::cos(-omega * 0.3), 0,
                       0.2 * omega * decay * std::sin(-omega * 0.3)};
  DragOptions options{.linear = 300, .coefficient = 1.2, .density = rho};
  const std::vector<double> w = test::wrenches_of(*make_face_drag(part, options, g, wave), state);
  const SurfacePlane plane = Waves(part, g, wave, {}).plane(0, {0, 0, -0.4}, 0.3);
  const double wet = Immersion(part).below(state, 0, plane).volume;
  const double factor = wet * (300 + 0.5 * rho * 1.2 * length(u));
  EXPECT_NEAR(w[0], factor * u.x, 1e-6 * factor * length(u));
  EXPECT_NEAR(w[2], factor * u.z, 1e-6 * factor * length(u));
  EXPECT_LT(u.z, 0);  // after a crest the surface falls
  EXPECT_GT(u.x, 0);  // below a crest the water moves with the wave
}

/// A box that touches neither air nor bottom feels the horizontal force of a wave as the water that
/// it displaces: rho V du/dt (Froude and Krylov), with the decay at its draft.
TEST(Waves, FroudeKrylovIsThereOnce) {
  const Lattice lattice = test::box({2, 2, 0.5}, 900, -0.25, {});
  const Part part = partition(lattice, PETSC_COMM_SELF);
  State<Spatial> state(1);
  const WaveOptions wave = of_length(80, 0.02);
  const double k = 2 * pi / 80, omega = std::sqrt(g * k);
  state.set_time(0.25 * 2 * pi / omega);  // no level, the largest slope: a crest comes from -x
  const auto buoyancy = make_buoyancy_in_waves(part, rho * g, g, wave);
  const std::vector<double> w = test::wrenches_of(*buoyancy, state);
  const double volume = Immersion(part).below(state, 0, {}).volume;
  EXPECT_NEAR(volume, 2.0, 1e-9);
  // du/dt = a omega^2 e^(k z) sin(k x - omega t)... at x = 0 and omega t = pi/2: -a omega^2.
  EXPECT_NEAR(w[0] / (-rho * volume * 0.01 * omega * omega * std::exp(-k * 0.5)), 1, 5e-3);
}

}  // namespace
}  // namespace floe
