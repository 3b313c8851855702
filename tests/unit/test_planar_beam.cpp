// The planar beam: its own energy, gradient, rates and tangent, and all of them against the spatial
// beam's on states in the plane.
#include <gtest/gtest.h>

#include <Eigen/Core>

#include "beams/planar.h"
#include "beams/spatial.h"
#include "support/planar.h"
#include "support/states.h"

namespace floe {
namespace {

using test::Random;
using Real = long double;
using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;

constexpr double pi = 3.14159265358979323846;

/// The same beam in the plane and in space: its axis 3 is z, stiffnesses out of plane are others.
struct Beam {
  PlanarConstants<double> planar;
  BeamConstants<double> spatial;
};
Beam random_beam(Random& random) {
  const double angle = random.uniform(0, 2 * pi), c = std::cos(angle), s = std::sin(angle);
  const auto stiffness = [&random] { return random.uniform(0.5, 2); };
  const PlanarConstants<double> p{
      {c, s}, random.uniform(0.7, 1.5), stiffness(), stiffness(), stiffness()};
  return {p,
          {{{c, s, 0}, {-s, c, 0}, {0, 0, 1}},
           p.l0,
           p.kn,
           p.ks,
           stiffness(),
           stiffness(),
           stiffness(),
           p.kb}};
}

/// Displacements up to 0.5 m, both bodies turned by any angle, j against i by up to `relative` rad;
/// random velocities.
State<Planar> random_pair(Random& random, double relative, double common = 20) {
  State<Planar> state(2);
  const double turn = random.uniform(-common, common);
  for (std::size_t b = 0; b < 2; ++b) {
    double* r = state.record(b);
    r[0] = random.uniform(-0.5, 0.5), r[1] = random.uniform(-0.5, 0.5);
    r[2] = turn + (b == 0 ? 0 : random.uniform(-relative, relative));
    for (int k = 0; k < 3; ++k) r[Planar::velocity + k] = random.uniform(-1, 1);
  }
  return state;
}

template <Kinematics kinematics>
PlanarGradient<double> gradient(const PlanarConstants<double>& beam, const State<Planar>& p) {
  const auto s = PlanarBeam<kinematics>::strains(beam, p.record(0), p.record(1));
  return PlanarKernel<kinematics>::gradient(beam, s, elastic_stress(beam, s));
}
template <Kinematics kinematics>
Vector6 wrenches(const PlanarConstants<double>& beam, const State<Planar>& p) {
  const PlanarGradient<double> g = gradient<kinematics>(beam, p);
  Vector6 w;
  w << g.force.x, g.force.y, -g.moment_i, -g.force.x, -g.force.y, -g.moment_j;
  return w;
}
template <Kinematics kinematics>
Matrix6 tangent(const PlanarConstants<double>& beam, const State<Planar>& p) {
  std::array<double, 36> k;
  PlanarBeam<kinematics>::tangent(beam, nullptr, p.record(0), p.record(1), true, k);
  return Eigen::Map<const Matrix6>(k.data());
}

/// Derivatives to the six unknowns of what `evaluate(beam, strains)` gives, in long double.
template <Kinematics kinematics, class Evaluate>
std::vector<std::vector<Real>> derivatives(const PlanarConstants<double>& b, const State<Planar>& p,
                                           const Evaluate& evaluate) {
  const PlanarConstants<Real> beam{{b.rest.c, b.rest.s}, b.l0, b.kn, b.ks, b.kb};
  std::vector<std::vector<Real>> by_unknown;
  for (std::size_t k = 0; k < 6; ++k) {
    const auto values = [&](Real amount) {
      std::array<Real, 6> x{};
      for (std::size_t a = 0; a < 6; ++a) x[a] = p.record(a / 3)[a % 3];
      x[k] += amount;
      return evaluate(beam, PlanarKernel<kinematics>::strains(
                                beam, Vec2<Real>{x[3] - x[0], x[4] - x[1]}, x[2], x[5]));
    };
    by_unknown.push_back(test::derivative<Real>(values, 1e-4L));
  }
  return by_unknown;
}

template <Kinematics kinematics>
void slopes() {
  Random random(1);
  for (int n = 0; n < 200; ++n) {
    const PlanarConstants<double> beam = random_beam(random).planar;
    const State<Planar> p = random_pair(random, 3);
    const auto energy = derivatives<kinematics>(
        beam, p, [](const auto& b, const auto& s) { return std::vector<Real>{beam_energy(b, s)}; });
    const auto slope = derivatives<kinematics>(beam, p, [](const auto& b, const auto& s) {
      const PlanarGradient<Real> g = PlanarKernel<kinematics>::gradient(b, s, elastic_stress(b, s));
      return std::vector<Real>{-g.force.x, -g.force.y, g.moment_i,
                               g.force.x,  g.force.y,  g.moment_j};
    });
    const Vector6 w = wrenches<kinematics>(beam, p);
    const Matrix6 k = tangent<kinematics>(beam, p);
    for (std::size_t r = 0; r < 6; ++r) {
      const auto row = static_cast<Eigen::Index>(r);
      EXPECT_NEAR(w[row], static_cast<double>(-energy[r][0]), 1e-9 * w.norm()) << n;
      for (std::size_t c = 0; c < 6; ++c)
        EXPECT_NEAR(k(row, static_cast<Eigen::Index>(c)), static_cast<double>(slope[c][r]),
                    1e-8 * k.norm())
            << n;
    }
    EXPECT_LT((k - k.transpose()).norm(), 1e-13 * k.norm());
  }
}

TEST(PlanarBeam, GradientIsTheSlopeOfTheEnergyAndTangentThatOfTheGradient) {
  slopes<Kinematics::corotational>();
  slopes<Kinematics::linear>();
}

template <Kinematics kinematics>
void as_in_space() {
  using Spatial3 = SpatialBeam<kinematics>;
  constexpr bool linear = kinematics == Kinematics::linear;
  Random random(2);
  for (int n = 0; n < 500; ++n) {
    const auto [planar, spatial] = random_beam(random);
    const double relative = n % 3 == 0 ? 1e-6 : n % 3 == 1 ? 0.15 : 3.0;
    const State<Planar> p = random_pair(random, relative, linear ? 1 : 20);
    const State<Spatial> q = in_space(p, linear);

    const BeamStrains<double> s = Spatial3::strains(spatial, q.record(0), q.record(1));
    const BeamGradient<double> g = Spatial3::Kernel::gradient(spatial, s);
    Vector6 expected;
    expected << g.force.x, g.force.y, -g.moment_i.z, -g.force.x, -g.force.y, -g.moment_j.z;
    EXPECT_LT((wrenches<kinematics>(planar, p) - expected).norm(), 1e-13 * expected.norm()) << n;

    const double energy = PlanarBeam<kinematics>::energy(planar, p.record(0), p.record(1));
    EXPECT_NEAR(energy / Spatial3::energy(spatial, q.record(0), q.record(1)), 1, 1e-13) << n;

    const BeamSection section = PlanarBeam<kinematics>::section(planar, p.record(0), p.record(1)),
                      in_full = Spatial3::section(spatial, q.record(0), q.record(1));
    for (std::size_t k = 0; k < 6; ++k) EXPECT_NEAR(section[k], in_full[k], 1e-13) << n << ' ' << k;

    const auto v = [&](std::size_t b) { return velocity(p, b); };
    const double wi = angular_velocity(p, 0).z, wj = angular_velocity(p, 1).z;
    const Vec3<double> d = v(1) - v(0);
    const PlanarStress<double> rate = PlanarKernel<kinematics>::rates(
        planar, PlanarBeam<kinematics>::strains(planar, p.record(0), p.record(1)),
        Vec2<double>{d.x, d.y}, wi, wj);
    const BeamStress<double> full =
        Spatial3::Kernel::rates(spatial, s, d, Vec3<double>{0, 0, wi}, Vec3<double>{0, 0, wj});
    EXPECT_NEAR(rate.n, full.n, 1e-13);
    EXPECT_NEAR(rate.q, full.qy, 1e-13);
    EXPECT_NEAR(rate.c, full.c.z, 1e-13);

    std::array<double, 144> k;
    Spatial3::tangent(spatial, nullptr, q.record(0), q.record(1), true, k);
    const std::vector<double> block = test::in_plane({k.begin(), k.end()}, 2);
    const Matrix6 mine = tangent<kinematics>(planar, p);
    EXPECT_LT((mine - Eigen::Map<const Matrix6>(block.data())).norm(), 1e-13 * mine.norm()) << n;

    // Dashpots: their force, the damping matrix, and how the force goes with the motion.
    const std::array<double, 3> c{0.3, 0.5, 0.7};
    const BeamDashpots all{0.3, 0.5, 0.9, 1.1, 1.3, 0.7};
    const BeamGradient<double> f = PlanarBeam<kinematics>::damping_force(planar, c, p.record(0),
                                                                         p.record(1)),
                               full_force =
                                   Spatial3::damping_force(spatial, all, q.record(0), q.record(1));
    EXPECT_NEAR(f.force.x, full_force.force.x, 1e-13);
    EXPECT_NEAR(f.force.y, full_force.force.y, 1e-13);
    EXPECT_NEAR(f.moment_i.z, full_force.moment_i.z, 1e-13);
    EXPECT_NEAR(f.moment_j.z, full_force.moment_j.z, 1e-13);
    std::array<double, 36> small;
    const auto expect_in_plane = [&](const char* what) {
      const std::vector<double> wanted = test::in_plane({k.begin(), k.end()}, 2);
      for (std::size_t a = 0; a < small.size(); ++a)
        EXPECT_NEAR(small[a], wanted[a], 1e-12) << what;
    };
    PlanarBeam<kinematics>::damping(planar, c, p.record(0), p.record(1), small);
    Spatial3::damping(spatial, all, q.record(0), q.record(1), k);
    expect_in_plane("damping");
    PlanarBeam<kinematics>::tangent(planar, &c, p.record(0), p.record(1), false, small);
    Spatial3::tangent(spatial, &all, q.record(0), q.record(1), false, k);
    expect_in_plane("tangent with dashpots");

    if (relative > 1) continue;  // at which beams fold
    EXPECT_EQ(PlanarBeam<kinematics>::is_folded(planar, p.record(0), p.record(1)),
              Spatial3::is_folded(spatial, q.record(0), q.record(1)));
  }
}

TEST(PlanarBeam, IsTheSpatialBeamInThePlane) {
  as_in_space<Kinematics::corotational>();
  as_in_space<Kinematics::linear>();
}

/// What the strains' rates times their stresses give is the power of the gradient.
TEST(PlanarBeam, RatesHaveThePowerOfTheGradient) {
  Random random(3);
  for (int n = 0; n < 200; ++n) {
    const PlanarConstants<double> beam = random_beam(random).planar;
    const State<Planar> p = random_pair(random, 3);
    const Vec3<double> d = velocity(p, 1) - velocity(p, 0);
    const double wi = angular_velocity(p, 0).z, wj = angular_velocity(p, 1).z;
    const auto s = PlanarBeam<Kinematics::corotational>::strains(beam, p.record(0), p.record(1));
    const PlanarStress<double> stress{random.uniform(-1, 1), random.uniform(-1, 1),
                                      random.uniform(-1, 1)};
    const PlanarStress<double> rate = corotational_rates(beam, s, Vec2<double>{d.x, d.y}, wi, wj);
    const PlanarGradient<double> g = corotational_gradient(beam, s, stress);
    EXPECT_NEAR(stress.n * rate.n + stress.q * rate.q + stress.c * rate.c,
                g.force.x * d.x + g.force.y * d.y + g.moment_i * wi + g.moment_j * wj, 1e-13);
  }
}

/// A beam along y; what one strain of size 1e-6 does, over the strain.
template <Kinematics kinematics>
void each_strain_has_its_stiffness() {
  const PlanarConstants<double> beam{{0, 1}, 2.0, 3.0, 5.0, 17.0};
  constexpr double size = 1e-6;
  const auto expect = [&](const std::array<double, 6>& motion,
                          const std::array<double, 6>& wrench) {
    State<Planar> p(2);
    for (std::size_t k = 0; k < 6; ++k) p.record(k / 3)[k % 3] = size * motion[k];
    const Vector6 seen = wrenches<kinematics>(beam, p) / size;
    EXPECT_LT((seen - Eigen::Map<const Vector6>(wrench.data())).norm(), 1e-4);
  };
  expect({0, 0, 0, 0, 1, 0}, {0, 3, 0, 0, -3, 0});
  expect({0, 0, 0, -1, 0, 0}, {-5, 0, 5, 5, 0, 5});  // axis 2 is -x; the couple Q l is shared
  expect({0, 0, -.5, 0, 0, .5}, {0, 0, 17, 0, 0, -17});
  expect({0, 0, 1, 0, 0, 1}, {10, 0, -10, -10, 0, -10});  // the chord stays behind by -l0
}

TEST(PlanarBeam, EachStrainHasItsStiffness) {
  each_strain_has_its_stiffness<Kinematics::corotational>();
  each_strain_has_its_stiffness<Kinematics::linear>();
}

TEST(PlanarBeam, RigidMotionOfAnySizeIsFree) {
  Random random(5);
  for (const double turn : {1e-9, 0.3, pi, 2 * pi + 0.1, 700.0}) {
    const PlanarConstants<double> beam = random_beam(random).planar;
    State<Planar> p(2);
    for (std::size_t b = 0; b < 2; ++b) {
      const double x = 1.7 + (b == 0 ? 0 : beam.l0 * beam.rest.c),
                   y = -0.4 + (b == 0 ? 0 : beam.l0 * beam.rest.s);
      double* r = p.record(b);
      r[0] = std::cos(turn) * x - std::sin(turn) * y - x + 5;
      r[1] = std::sin(turn) * x + std::cos(turn) * y - y - 3;
      r[2] = turn;
    }
    EXPECT_LT(wrenches<Kinematics::corotational>(beam, p).norm(), 1e-13) << turn;
  }
}

TEST(PlanarBeam, StrainsOfOnePartInATrillionAreSeen) {
  constexpr double tiny = 1e-12;
  Random random(6);
  for (int n = 0; n < 100; ++n) {
    const PlanarConstants<double> beam = random_beam(random).planar;
    const auto section = [&](const State<Planar>& p) {
      return PlanarBeam<Kinematics::corotational>::section(beam, p.record(0), p.record(1));
    };
    State<Planar> longer(2), sheared(2), bent(2);
    longer.record(1)[0] = tiny * beam.l0 * beam.rest.c;
    longer.record(1)[1] = tiny * beam.l0 * beam.rest.s;
    sheared.record(1)[0] = -tiny * beam.l0 * beam.rest.s;
    sheared.record(1)[1] = tiny * beam.l0 * beam.rest.c;
    bent.record(0)[2] = -0.5 * tiny, bent.record(1)[2] = 0.5 * tiny;
    EXPECT_NEAR(section(longer)[0] / (tiny * beam.l0 * beam.kn), 1, 1e-10);
    EXPECT_NEAR(section(sheared)[1] / (tiny * beam.l0 * beam.ks), 1, 1e-3);
    EXPECT_NEAR(section(bent)[5] / (tiny * beam.kb), 1, 1e-3);
  }
}

}  // namespace
}  // namespace floe
