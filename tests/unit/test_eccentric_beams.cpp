// Beams that end off the centroids of their bodies: the same beams as between other points of the
// same bodies; tangent and damping; statics in closed form.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "beams/beam_force.h"
#include "beams/spatial_lanes.h"
#include "floe/base/item.h"
#include "lattice/partition.h"
#include "support/force_checks.h"
#include "support/frames.h"
#include "support/lattices.h"
#include "support/random.h"
#include "support/states.h"
#include "support/static_solution.h"

namespace floe {
namespace {

using test::Random;

/// A zigzag in space of beams whose sections differ in every number.
Lattice zigzag() {
  const test::FrameSection section{0.12, 4e-4, 3e-3, 1.1e-3, 4e9, 1.5e9, 0.8};
  return test::frame({{0, 0, 0}, {1, 0.1, 0.2}, {1.7, 0.8, -0.1}, {2.8, 0.7, 0.3}}, section,
                     {{0, 1, 0}, {0, 0, 1}, {0, 1, 0}});
}

/// The same frame on bodies whose centroids lie elsewhere: by moves[b] from where the beams end.
Lattice with_centroids_moved(Lattice lattice, const std::vector<Point3>& moves) {
  for (std::size_t b = 0; b < moves.size(); ++b)
    lattice.bodies.position[b] = lattice.bodies.position[b] + moves[b];
  for (const auto& [i, j] : lattice.beams.bodies)
    lattice.beams.offsets.push_back({-item(moves, i), -item(moves, j)});
  return lattice;
}

std::vector<Point3> random_moves(Random& random, std::int32_t bodies) {
  std::vector<Point3> moves;
  for (std::int32_t b = 0; b < bodies; ++b) moves.push_back(random.vector(0.4));
  return moves;
}

/// Forces and moments on bodies whose centroids are moved by s are those of the beams between the
/// ends: f' = f, m' = m - a x f with the arm a = R s; displacements u' = u + a - s, velocities
/// v' = v + w x a.
template <Kinematics kinematics>
void compare(double turn, double damping) {
  Random random(3);
  for (int repeat = 0; repeat < 20; ++repeat) {
    const Lattice plain = zigzag();
    const std::vector<Point3> moves = random_moves(random, plain.bodies.size());
    const Lattice moved = with_centroids_moved(plain, moves);
    const Part part = partition(plain, PETSC_COMM_SELF), other = partition(moved, PETSC_COMM_SELF);
    State<Spatial> a(moves.size()), b(moves.size());
    std::vector<Vec3<double>> arms;
    for (std::size_t k = 0; k < moves.size(); ++k) {
      const Vec3<double> u = random.vector(0.1), v = random.vector(1), w = random.vector(1);
      Quat<double> q = random.rotation(random.uniform(0, turn));
      Vec3<double> arm = rotate(q, moves[k]), to = u + arm - moves[k];
      if (kinematics == Kinematics::linear) {
        q.w = 1;
        arm = moves[k];
        to = u + 2.0 * cross(Vec3<double>{q.x, q.y, q.z}, moves[k]);
      }
      arms.push_back(arm);
      const Vec3<double> faster = v + cross(w, arm);
      const auto put = [&](State<Spatial>& s, const Vec3<double>& d, const Vec3<double>& speed) {
        const std::array<double, 13> all{d.x,     d.y,     d.z,     q.w, q.x, q.y, q.z,
                                         speed.x, speed.y, speed.z, w.x, w.y, w.z};
        std::copy(all.begin(), all.end(), s.record(k));
      };
      put(a, u, v), put(b, to, faster);
    }
    // Damping depends on the bodies' inertia, not on their centroids.
    BeamOptions options{Shear::exact, kinematics};
    options.damping_ratio = damping;
    const auto plain_force = make_beam_force<Spatial>(part, options),
               moved_force = make_beam_force<Spatial>(other, options);
    const std::vector<double> f = test::wrenches_of(*plain_force, a),
                              g = test::wrenches_of(*moved_force, b);
    double scale = 0;
    for (const double x : f) scale = std::max(scale, std::abs(x));
    for (std::size_t k = 0; k < moves.size(); ++k) {
      const auto three = [](const std::vector<double>& x, std::size_t at) {
        return Vec3<double>{x[at], x[at + 1], x[at + 2]};
      };
      const Vec3<double> force = three(f, 6 * k), moment = three(f, 6 * k + 3),
                         expected = moment - cross(arms[k], force);
      for (std::size_t c = 0; c < 3; ++c) {
        EXPECT_NEAR(three(g, 6 * k)[c], force[c], 1e-11 * scale) << "body " << k;
        EXPECT_NEAR(three(g, 6 * k + 3)[c], expected[c], 1e-11 * scale) << "body " << k;
      }
    }
  }
}

TEST(EccentricBeams, AreTheBeamsBetweenTheirEnds) {
  compare<Kinematics::corotational>(0.3, 0);
  compare<Kinematics::corotational>(2.5, 0);
  compare<Kinematics::corotational>(0.3, 0.2);
  compare<Kinematics::linear>(0.1, 0);
  compare<Kinematics::linear>(0.1, 0.2);
}

template <Kinematics kinematics>
using Eccentric = SpatialBeam<kinematics, EccentricFrame>;

BeamConstants<double, EccentricFrame> random_beam(Random& random) {
  BeamConstants<double, EccentricFrame> c{};
  const Triad<double> t = triad(random.rotation(random.uniform(0, 3)));
  c.rest = {{t.e1, t.e2, t.e3}, random.vector(0.5), random.vector(0.5)};
  c.l0 = random.uniform(0.7, 1.5);
  for (double* k : {&c.kn, &c.ksz, &c.ksy, &c.kt, &c.kby, &c.kbz}) *k = random.uniform(0.5, 2);
  return c;
}

State<Spatial> random_state(Random& random, Kinematics kinematics) {
  State<Spatial> state(2);
  for (std::size_t b = 0; b < 2; ++b) {
    const Vec3<double> u = random.vector(0.3), v = random.vector(1), w = random.vector(1);
    const Quat<double> q = random.rotation(random.uniform(0, 1));
    const std::array<double, 13> all{
        u.x, u.y, u.z, kinematics == Kinematics::linear ? 1 : q.w, q.x, q.y, q.z, v.x, v.y, v.z,
        w.x, w.y, w.z};
    std::copy(all.begin(), all.end(), state.record(b));
  }
  return state;
}

/// Minus the wrenches on both bodies: force and moment of i, then of j.
template <Kinematics kinematics>
std::array<double, 12> gradient(const BeamConstants<double, EccentricFrame>& c,
                                const State<Spatial>& s) {
  using Beam = Eccentric<kinematics>;
  const BeamGradient<double> g =
      Beam::Kernel::gradient(c, Beam::strains(c, s.record(0), s.record(1)));
  return {-g.force.x, -g.force.y, -g.force.z, g.moment_i.x, g.moment_i.y, g.moment_i.z,
          g.force.x,  g.force.y,  g.force.z,  g.moment_j.x, g.moment_j.y, g.moment_j.z};
}

template <Kinematics kinematics>
void move(State<Spatial>& state, std::size_t unknown, double amount) {
  double* r = state.record(unknown / 6);
  const std::size_t k = unknown % 6;
  if (k < 3) {
    r[k] += amount;
  } else if (kinematics == Kinematics::linear) {
    r[k + 1] += amount / 2;
  } else {
    Quat<double> spin{std::cos(amount / 2), 0, 0, 0};
    (k == 3 ? spin.x : k == 4 ? spin.y : spin.z) = std::sin(amount / 2);
    const Quat<double> q = product(spin, Quat<double>{r[3], r[4], r[5], r[6]});
    r[3] = q.w, r[4] = q.x, r[5] = q.y, r[6] = q.z;
  }
}

template <Kinematics kinematics>
void check_derivatives() {
  Random random(4);
  using Beam = Eccentric<kinematics>;
  for (int repeat = 0; repeat < 20; ++repeat) {
    const auto c = random_beam(random);
    const State<Spatial> state = random_state(random, kinematics);
    const std::array<double, 12> g = gradient<kinematics>(c, state);
    std::array<double, 144> k{}, h{}, b{};
    Beam::tangent(c, nullptr, state.record(0), state.record(1), false, k);
    Beam::tangent(c, nullptr, state.record(0), state.record(1), true, h);
    constexpr double step = 1e-5;
    for (std::size_t column = 0; column < 12; ++column) {
      State<Spatial> more = state, less = state;
      move<kinematics>(more, column, step), move<kinematics>(less, column, -step);
      const auto energy = [&](const State<Spatial>& s) {
        return Beam::energy(c, s.record(0), s.record(1));
      };
      EXPECT_NEAR(g[column], (energy(more) - energy(less)) / (2 * step), 1e-8);
      const auto up = gradient<kinematics>(c, more), down = gradient<kinematics>(c, less);
      for (std::size_t row = 0; row < 12; ++row) {
        EXPECT_NEAR(k[12 * row + column], (up[row] - down[row]) / (2 * step), 1e-7);
        EXPECT_NEAR(h[12 * row + column], h[12 * column + row], 1e-12);
      }
    }
    // Dashpots: linear in the velocities.
    const BeamDashpots dashpots{0.3, 0.5, 0.7, 1.1, 1.3, 1.7};
    Beam::damping(c, dashpots, state.record(0), state.record(1), b);
    for (std::size_t column = 0; column < 12; ++column) {
      State<Spatial> unit = state;
      for (std::size_t body = 0; body < 2; ++body)
        std::fill_n(unit.record(body) + Spatial::velocity, 6, 0.0);
      unit.record(column / 6)[Spatial::velocity + column % 6] = 1;
      const BeamGradient<double> f =
          Beam::damping_force(c, dashpots, unit.record(0), unit.record(1));
      const std::array<double, 12> all{-f.force.x,   -f.force.y,   -f.force.z,   f.moment_i.x,
                                       f.moment_i.y, f.moment_i.z, f.force.x,    f.force.y,
                                       f.force.z,    f.moment_j.x, f.moment_j.y, f.moment_j.z};
      for (std::size_t row = 0; row < 12; ++row) EXPECT_NEAR(b[12 * row + column], all[row], 1e-12);
    }
  }
}

TEST(EccentricBeams, GradientTangentAndDampingAreDerivatives) {
  check_derivatives<Kinematics::corotational>();
  check_derivatives<Kinematics::linear>();
}

// A row of n beams at the height c over the centroids, held at one end and pulled at the other by
// F: each beam has N = F and the moment F c, so the end turns by n F c l/(E I), rises by
// F c L^2/(2 E I) less the half steps of bodies, and its centroid moves by F L/(E A) + c times the
// turn.
TEST(EccentricBeams, APulledRowBends) {
  constexpr int n = 8;
  const double l = 0.5, c = 0.07, pull = 1e-3, length = n * l;
  const test::FrameSection section{0.12, 4e-4, 3e-3, 1.1e-3, 4e9, 1.5e9, 0.8};
  Lattice lattice = test::straight_frame(length, n, section);
  lattice.beams.offsets.assign(n, {Point3{0, 0, c}, Point3{0, 0, c}});
  for (const Shear shear : {Shear::one_point, Shear::exact}) {
    Scene scene;
    scene.forces.beam = true;
    scene.beam = {shear, Kinematics::linear};
    Boundary root;
    root.set = "root";
    root.fixed.fill(true);
    scene.boundaries = {root};
    Load load;
    load.set = "tip";
    load.force = {pull, 0, 0};
    scene.loads = {load};
    const auto solution = test::solve_static(scene, lattice);
    ASSERT_TRUE(solution.result.done);
    const double ei = section.young * section.inertia_y, ea = section.young * section.area;
    const double turn = pull * c * length / ei;  // about -y: the end rises
    const Vec3<double> u = displacement(solution.last(), n);
    const Quat<double> q = rotation(solution.last(), n);
    EXPECT_NEAR(-2 * q.y / turn, 1, 1e-9);
    EXPECT_NEAR(u.x / (pull * length / ea + c * turn), 1, 1e-9);
    double rise = 0;
    for (int k = 0; k < n; ++k) rise += l * turn * (k + 0.5) / n;
    EXPECT_NEAR(u.z / rise, 1, 1e-9);
  }
}

}  // namespace
}  // namespace floe
