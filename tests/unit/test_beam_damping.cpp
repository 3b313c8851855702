// Dashpots of beams: they never give power, balance forces and moments, have the stated strength,
// and two bodies joined by one beam decay as a damped oscillator does.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "support/dynamics.h"
#include "support/lattices.h"
#include "support/states.h"

namespace floe {
namespace {

using test::Dynamics;
using test::Random;

constexpr double ice_length = 1.3;

Scene damped_scene(double ratio, DampingModes modes, Shear shear = Shear::one_point) {
  Scene scene;
  scene.forces.beam = true;
  scene.beam.damping_ratio = ratio;
  scene.beam.damping_modes = modes;
  scene.beam.shear = shear;
  return scene;
}

/// What the dashpots add to the wrenches at a state.
Wrenches<Spatial> viscous(const Lattice& lattice, const BeamOptions& options,
                          const State<Spatial>& state) {
  const Part part = partition(lattice, PETSC_COMM_SELF);
  BeamOptions springs = options;
  springs.damping_ratio = 0;
  const auto local = static_cast<std::size_t>(part.local);
  Wrenches<Spatial> with(local), without(local);
  make_beam_force<Spatial>(part, options)->add(state, with);
  make_beam_force<Spatial>(part, springs)->add(state, without);
  for (std::size_t k = 0; k < with.values.size(); ++k) with.values[k] -= without.values[k];
  return with;
}

void put_random_velocities(State<Spatial>& state, Random& random) {
  for (std::size_t b = 0; b < state.records.size() / Spatial::record; ++b) {
    const Vec3<double> v = random.vector(1), w = random.vector(1);
    double* r = state.record(b) + Spatial::velocity;
    r[0] = v.x, r[1] = v.y, r[2] = v.z, r[3] = w.x, r[4] = w.y, r[5] = w.z;
  }
}

class Dashpots : public testing::TestWithParam<std::pair<DampingModes, Kinematics>> {
 protected:
  BeamOptions options() const { return {Shear::exact, GetParam().second, 0.7, GetParam().first}; }
};

/// Beams of a flat sheet keep their triads in two numbers, those of any other lattice in nine: a
/// sheet that stands askew, with all that moves in it, has the same forces, turned.
TEST_P(Dashpots, FlatSheetAndTheSameStandingAskewHaveTheSameForces) {
  const Lattice flat = test::sheet(6, 5, 1);
  Lattice askew = flat;
  const Quat<double> turn = exp_rotation({0.7, -0.3, 1.2});
  const auto turned = [&](Point3& x) { x = rotate(turn, x); };
  const auto turn_numbers = [&](double* of) {
    const Point3 x = rotate(turn, {of[0], of[1], of[2]});
    of[0] = x.x, of[1] = x.y, of[2] = x.z;
  };
  std::for_each(askew.bodies.position.begin(), askew.bodies.position.end(), turned);
  std::for_each(askew.beams.axis_y.begin(), askew.beams.axis_y.end(), turned);
  for (auto& [w, x, y, z] : askew.bodies.orientation) {
    const Quat<double> q = product(turn, Quat<double>{w, x, y, z});
    w = q.w, x = q.x, y = q.y, z = q.z;
  }
  const auto wrenches = [&](const Lattice& lattice, bool turn_state) {
    const Part part = partition(lattice, PETSC_COMM_SELF);
    State<Spatial> state = test::deformed(part, 0.1, 0.2);
    Random random(8);
    put_random_velocities(state, random);
    for (std::size_t b = 0; turn_state && b < static_cast<std::size_t>(part.local); ++b) {
      double* r = state.record(b);
      for (double* v :
           {r, r + Spatial::rotation + 1, r + Spatial::velocity, r + Spatial::angular_velocity})
        turn_numbers(v);
    }
    Wrenches<Spatial> w(static_cast<std::size_t>(part.local));
    make_beam_force<Spatial>(part, options())->add(state, w);
    return w;
  };
  Wrenches<Spatial> expected = wrenches(flat, false), seen = wrenches(askew, true);
  double size = 0, difference = 0;
  for (std::size_t k = 0; k < expected.values.size(); k += Spatial::wrench) {
    for (const std::size_t first : {k, k + 3}) turn_numbers(expected.values.data() + first);
    for (std::size_t a = k; a < k + 6; ++a) {
      size = std::max(size, std::abs(expected.values[a]));
      difference = std::max(difference, std::abs(seen.values[a] - expected.values[a]));
    }
  }
  EXPECT_GT(size, 0);
  EXPECT_LT(difference, 1e-12 * size);
}

TEST_P(Dashpots, TakePowerAndBalanceForcesAndMoments) {
  const Lattice lattice = test::sheet(6, 5, 1);
  const Part part = partition(lattice, PETSC_COMM_SELF);
  Random random(3);
  const bool linear = GetParam().second == Kinematics::linear;
  for (const double turn : {1e-3, 0.3, 2.0}) {
    State<Spatial> state = test::deformed(part, linear ? 1e-3 : 0.3, linear ? 0.0 : turn);
    put_random_velocities(state, random);
    const Wrenches<Spatial> w = viscous(lattice, options(), state);
    Vec3<double> force{0, 0, 0}, moment{0, 0, 0};
    double power = 0, size = 0, turning = 0;
    for (std::size_t b = 0; b < static_cast<std::size_t>(part.local); ++b) {
      const double* f = w.of(b);
      const double* v = state.record(b) + Spatial::velocity;
      for (std::size_t k = 0; k < 6; ++k) power += f[k] * v[k];
      const Vec3<double> mine{f[0], f[1], f[2]};
      const Vec3<double> u = linear ? Vec3<double>{0, 0, 0} : displacement(state, b);
      const Vec3<double> at = part.bodies.position[b] + u;
      force = force + mine;
      moment = moment + Vec3<double>{f[3], f[4], f[5]} + cross(at, mine);
      size += std::sqrt(dot(mine, mine));
      turning += std::sqrt(dot(at, at) * dot(mine, mine));
    }
    EXPECT_LT(power, 0);
    EXPECT_LT(std::sqrt(dot(force, force)), 1e-12 * size);
    EXPECT_LT(std::sqrt(dot(moment, moment)), 1e-12 * turning);
  }
}

/// Beam by beam and velocity by velocity, not only in the sum.
TEST_P(Dashpots, NeverGivePower) {
  const bool linear = GetParam().second == Kinematics::linear;
  const Lattice lattice = test::row(2);
  const Part part = partition(lattice, PETSC_COMM_SELF);
  Random random(11);
  for (int n = 0; n < 2000; ++n) {
    State<Spatial> state(2);
    for (std::size_t b = 0; b < 2 && !linear; ++b) {
      const Vec3<double> u = random.vector(0.4);
      double* r = state.record(b);
      r[0] = u.x, r[1] = u.y, r[2] = u.z;
      test::put_rotation(state, b, random.rotation(random.uniform(0, 1.5)));
    }
    put_random_velocities(state, random);
    const Wrenches<Spatial> w = viscous(lattice, options(), state);
    double power = 0, size = 0;
    for (std::size_t b = 0; b < 2; ++b) {
      for (std::size_t k = 0; k < 6; ++k) {
        const double p =
            w.of(b)[k] * state.record(b)[static_cast<std::size_t>(Spatial::velocity) + k];
        power += p;
        size += std::abs(p);
      }
    }
    ASSERT_LE(power, 1e-12 * size) << n;
  }
}

/// A rigid motion, of any size, meets no dashpot.
TEST_P(Dashpots, DoNotSeeRigidMotion) {
  if (GetParam().second == Kinematics::linear) GTEST_SKIP() << "rotations are small there";
  const Lattice lattice = test::sheet(6, 5, 1);
  const Part part = partition(lattice, PETSC_COMM_SELF);
  Random random(5);
  const Quat<double> q = random.rotation(2.2);
  const Vec3<double> v = random.vector(1), w = random.vector(1), t = random.vector(3);
  State<Spatial> state(static_cast<std::size_t>(part.local));
  for (std::size_t b = 0; b < static_cast<std::size_t>(part.local); ++b) {
    const Vec3<double> x = part.bodies.position[b], at = rotate(q, x) + t, u = at - x;
    const Vec3<double> speed = v + cross(w, at);
    double* r = state.record(b);
    r[0] = u.x, r[1] = u.y, r[2] = u.z;
    test::put_rotation(state, b, q);
    r[7] = speed.x, r[8] = speed.y, r[9] = speed.z, r[10] = w.x, r[11] = w.y, r[12] = w.z;
  }
  // Against one body that moves by itself with 1 m/s.
  State<Spatial> alone(static_cast<std::size_t>(part.local));
  alone.record(7)[Spatial::velocity] = 1;
  const auto largest = [](const Wrenches<Spatial>& a) {
    double m = 0;
    for (const double f : a.values) m = std::max(m, std::abs(f));
    return m;
  };
  EXPECT_LT(largest(viscous(lattice, options(), state)),
            1e-7 * largest(viscous(lattice, options(), alone)));
}

INSTANTIATE_TEST_SUITE_P(All, Dashpots,
                         testing::Values(std::pair{DampingModes::all, Kinematics::corotational},
                                         std::pair{DampingModes::axial, Kinematics::corotational},
                                         std::pair{DampingModes::all, Kinematics::linear},
                                         std::pair{DampingModes::axial, Kinematics::linear}));

// -- one mode at a time ---------------------------------------------------------------------------

enum class Mode { axial, shear_y, shear_z, torsion, bending_y, bending_z };
constexpr Mode all_modes[] = {Mode::axial,   Mode::shear_y,   Mode::shear_z,
                              Mode::torsion, Mode::bending_y, Mode::bending_z};

/// Two different bodies and a beam along x.
Lattice pair_of_bodies() {
  Lattice lattice = test::frame({{0, 0, 0}, {ice_length, 0, 0}}, {{0, 1}});
  lattice.bodies.mass = {2, 5};
  lattice.bodies.inertia = {{0.3, 0.4, 0.5}, {1.1, 0.7, 0.9}};
  return lattice;
}

/// The unknown that a mode moves; all others are held.
int component(Mode mode) { return static_cast<int>(mode); }

double stiffness(const BeamStiffness& k, Mode mode) {
  const double all[] = {k.kn, k.ksz, k.ksy, k.kt, k.kby, k.kbz};
  return all[static_cast<int>(mode)];
}

/// Inertia of a body in a mode.
double inertia(const Lattice& lattice, std::size_t body, Mode mode) {
  const int k = component(mode);
  return k < 3 ? lattice.bodies.mass[body]
               : lattice.bodies.inertia[body][static_cast<std::size_t>(k - 3)];
}

/// Coefficient of the dashpot by the formula of model.md, "Explicit dynamics": Damping.
double dashpot(const Lattice& lattice, const BeamStiffness& k, Mode mode, double ratio) {
  const double a = inertia(lattice, 0, mode), b = inertia(lattice, 1, mode);
  return 2 * ratio * std::sqrt(2 * a * b / (a + b) * stiffness(k, mode));
}

/// Largest error, over the start, of the second body's motion against the first one held, from the
/// closed form x'' + 2 d x' + w0^2 x = 0; x(0) = x0, x'(0) = 0.
///
/// A bent beam also shears: with the centroids held, turning body j by psi shears the chord by
/// l0 psi/2, which adds k_s l0^2/4 to the stiffness and c_s l0^2/4 to the dashpot.
double error_of_decay(Mode mode, double ratio, DampingModes damped) {
  Lattice lattice = pair_of_bodies();
  Scene scene = damped_scene(ratio, damped);
  Boundary root, guide;
  root.name = "root", root.set = "first", root.fixed.fill(true);
  guide.name = "guide", guide.set = "last", guide.fixed.fill(true);
  guide.fixed[static_cast<std::size_t>(component(mode))] = false;
  scene.boundaries = {root, guide};
  const BeamStiffness k = beam_stiffness(lattice.beams, 0, scene.beam.shear);
  const bool damps = ratio > 0 && (damped == DampingModes::all || mode == Mode::axial);
  double spring = stiffness(k, mode), c = damps ? dashpot(lattice, k, mode, ratio) : 0;
  if (mode == Mode::bending_y || mode == Mode::bending_z) {
    const Mode with = mode == Mode::bending_y ? Mode::shear_z : Mode::shear_y;
    const double arm2 = 0.25 * ice_length * ice_length;
    spring += arm2 * stiffness(k, with);
    c += damps ? arm2 * dashpot(lattice, k, with, ratio) : 0;
  }
  const double m = inertia(lattice, 1, mode), w0 = std::sqrt(spring / m), d = 0.5 * c / m;
  const double start = 1e-6;
  Dynamics run(scene, lattice);
  test::move(run.state(), 1, component(mode), start);
  run.evaluate();
  const int steps = 20000;
  const double dt = 3 * 2 * 3.14159265358979 / w0 / steps;
  run.set_step(dt);
  double error = 0;
  for (int n = 1; n <= steps; ++n) {
    (void)run.step();
    const double t = n * dt, w2 = w0 * w0 - d * d, w = std::sqrt(std::abs(w2));
    const double exact =
        start * (w2 > 0 ? std::exp(-d * t) * (std::cos(w * t) + d / w * std::sin(w * t))
                        : 0.5 * ((1 + d / w) * std::exp((w - d) * t) +
                                 (1 - d / w) * std::exp(-(w + d) * t)));
    const double* r = run.state().record(1);
    const double at = mode < Mode::torsion ? r[component(mode)] : 2 * r[1 + component(mode)];
    error = std::max(error, std::abs(at - exact) / start);
  }
  return error;
}

TEST(Oscillator, DecaysByTheStatedDashpotInEveryMode) {
  for (const Mode mode : all_modes) {
    for (const double ratio : {0.0, 0.1, 0.6, 1.0}) {
      EXPECT_LT(error_of_decay(mode, ratio, DampingModes::all), 1e-3)
          << static_cast<int>(mode) << " " << ratio;
    }
  }
}

TEST(Oscillator, AxialDampsTheElongationOnly) {
  for (const Mode mode : all_modes)
    EXPECT_LT(error_of_decay(mode, 0.5, DampingModes::axial), 1e-3) << static_cast<int>(mode);
}

}  // namespace
}  // namespace floe
