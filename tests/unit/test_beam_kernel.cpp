// The beam: energy, gradient, tangent, invariance, stiffness of each mode, precision at tiny
// strains.
#include <gtest/gtest.h>

#include <Eigen/Core>

#include "beams/kernel.h"
#include "beams/spatial.h"
#include "support/random.h"
#include "support/states.h"

namespace floe {
namespace {

using test::Random;
using Corotational = SpatialBeam<Kinematics::corotational>;
using Linear = SpatialBeam<Kinematics::linear>;
using Vector12 = Eigen::Matrix<double, 12, 1>;
using Matrix12 = Eigen::Matrix<double, 12, 12, Eigen::RowMajor>;
using Real = long double;

constexpr double pi = 3.14159265358979323846;

/// Two records one after the other, at rest.
struct Pair {
  State<Spatial> state{2};
  double* i() { return state.record(0); }
  double* j() { return state.record(1); }
  const double* i() const { return state.record(0); }
  const double* j() const { return state.record(1); }
};

BeamConstants<double> random_beam(Random& random) {
  const Vec3<double> e1 = random.direction();
  Vec3<double> e2 = cross(e1, random.direction());
  e2 = (1 / std::sqrt(dot(e2, e2))) * e2;
  const auto stiffness = [&random] { return random.uniform(0.5, 2); };
  return {{e1, e2, cross(e1, e2)},
          random.uniform(0.7, 1.5),
          stiffness(),
          stiffness(),
          stiffness(),
          stiffness(),
          stiffness(),
          stiffness()};
}

/// Displacements up to 0.5 m; both bodies turned by any angle, j against i by up to `relative` rad.
Pair random_pair(Random& random, double relative) {
  Pair p;
  for (std::size_t b = 0; b < 2; ++b) {
    const Vec3<double> u = random.vector(0.5);
    double* r = p.state.record(b);
    r[0] = u.x, r[1] = u.y, r[2] = u.z;
  }
  const Quat<double> q = random.rotation(random.uniform(0, 2 * pi));
  test::put_rotation(p.state, 0, q);
  test::put_rotation(p.state, 1,
                     normalised(product(q, random.rotation(random.uniform(0, relative)))));
  return p;
}

/// Small displacements and the linearised quaternions (1, theta/2).
Pair random_linear_pair(Random& random) {
  Pair p;
  for (std::size_t b = 0; b < 2; ++b) {
    const Vec3<double> u = random.vector(0.5), t = random.vector(0.5);
    double* r = p.state.record(b);
    r[0] = u.x, r[1] = u.y, r[2] = u.z, r[3] = 1, r[4] = t.x, r[5] = t.y, r[6] = t.z;
  }
  return p;
}

template <class Beam>
Vector12 wrenches(const BeamConstants<double>& beam, const Pair& p) {
  const BeamGradient<double> g = Beam::Kernel::gradient(beam, Beam::strains(beam, p.i(), p.j()));
  Vector12 w;
  w << g.force.x, g.force.y, g.force.z, -g.moment_i.x, -g.moment_i.y, -g.moment_i.z, -g.force.x,
      -g.force.y, -g.force.z, -g.moment_j.x, -g.moment_j.y, -g.moment_j.z;
  return w;
}
template <class Beam>
Matrix12 tangent(const BeamConstants<double>& beam, const Pair& p, bool symmetric) {
  std::array<double, 144> k;
  Beam::tangent(beam, nullptr, p.i(), p.j(), symmetric, k);
  return Eigen::Map<const Matrix12>(k.data());
}
template <class Beam>
double energy(const BeamConstants<double>& beam, const Pair& p) {
  return Beam::energy(beam, p.i(), p.j());
}

// The same kernel in long double, for finite differences that are exact to 1e-13.

BeamConstants<Real> in_long_double(const BeamConstants<double>& b) {
  const auto v = [](const Vec3<double>& a) { return Vec3<Real>{a.x, a.y, a.z}; };
  return {{v(b.rest.e1), v(b.rest.e2), v(b.rest.e3)}, b.l0, b.kn, b.ksz, b.ksy, b.kt, b.kby, b.kbz};
}

struct RealBody {
  Vec3<Real> u;
  Quat<Real> q;
};
RealBody in_long_double(const double* r) { return {{r[0], r[1], r[2]}, {r[3], r[4], r[5], r[6]}}; }

template <Kinematics kinematics>
void move(RealBody& body, int k, Real amount) {
  if (k < 3) {
    (k == 0 ? body.u.x : k == 1 ? body.u.y : body.u.z) += amount;
    return;
  }
  if constexpr (kinematics == Kinematics::linear) {
    (k == 3 ? body.q.x : k == 4 ? body.q.y : body.q.z) += amount / 2;
  } else {
    const Real c = std::cos(amount / 2), s = std::sin(amount / 2);
    body.q = product(Quat<Real>{c, k == 3 ? s : 0, k == 4 ? s : 0, k == 5 ? s : 0}, body.q);
  }
}

/// Derivatives of something that `evaluate(strains)` gives, to the 12 unknowns.
template <Kinematics kinematics, class Evaluate>
std::vector<std::vector<Real>> derivatives(const BeamConstants<double>& beam, const Pair& p,
                                           const Evaluate& evaluate) {
  const BeamConstants<Real> exact = in_long_double(beam);
  std::vector<std::vector<Real>> by_unknown;
  for (int k = 0; k < 12; ++k) {
    const auto values = [&](Real amount) {
      RealBody i = in_long_double(p.i()), j = in_long_double(p.j());
      move<kinematics>(k < 6 ? i : j, k % 6, amount);
      return evaluate(exact, BeamKernel<kinematics>::strains(exact, j.u - i.u, i.q, j.q));
    };
    by_unknown.push_back(test::derivative<Real>(values, 1e-4L));
  }
  return by_unknown;
}

template <Kinematics kinematics>
Vector12 energy_slope(const BeamConstants<double>& beam, const Pair& p) {
  const auto value = [](const BeamConstants<Real>& b, const BeamStrains<Real>& s) {
    return std::vector<Real>{beam_energy(b, s)};
  };
  Vector12 slope;
  const auto by_unknown = derivatives<kinematics>(beam, p, value);
  for (int k = 0; k < 12; ++k)
    slope[k] = static_cast<double>(by_unknown[static_cast<std::size_t>(k)][0]);
  return slope;
}

template <Kinematics kinematics>
Matrix12 gradient_slope(const BeamConstants<double>& beam, const Pair& p) {
  const auto value = [](const BeamConstants<Real>& b, const BeamStrains<Real>& s) {
    const BeamGradient<Real> g = BeamKernel<kinematics>::gradient(b, s);
    return std::vector<Real>{-g.force.x,   -g.force.y,   -g.force.z,   g.moment_i.x,
                             g.moment_i.y, g.moment_i.z, g.force.x,    g.force.y,
                             g.force.z,    g.moment_j.x, g.moment_j.y, g.moment_j.z};
  };
  Matrix12 slope;
  const auto by_unknown = derivatives<kinematics>(beam, p, value);
  for (int c = 0; c < 12; ++c) {
    for (int r = 0; r < 12; ++r)
      slope(r, c) =
          static_cast<double>(by_unknown[static_cast<std::size_t>(c)][static_cast<std::size_t>(r)]);
  }
  return slope;
}

/// skew(m) of the moment gradients on the rotation blocks, where m x v = skew(m) v.
Matrix12 skew_of_moments(const Vector12& wrench) {
  Matrix12 s = Matrix12::Zero();
  for (const int at : {3, 9}) {
    const double x = -wrench[at], y = -wrench[at + 1], z = -wrench[at + 2];
    s.block<3, 3>(at, at) << 0, -z, y, z, 0, -x, -y, x, 0;
  }
  return s;
}

TEST(BeamKernel, GradientIsTheSlopeOfTheEnergy) {
  Random random(1);
  for (int k = 0; k < 200; ++k) {
    const BeamConstants<double> beam = random_beam(random);
    const Pair p = random_pair(random, 3.0);
    const Vector12 w = wrenches<Corotational>(beam, p);
    EXPECT_LT((w + energy_slope<Kinematics::corotational>(beam, p)).norm(), 1e-9 * w.norm()) << k;
    const Pair q = random_linear_pair(random);
    const Vector12 v = wrenches<Linear>(beam, q);
    EXPECT_LT((v + energy_slope<Kinematics::linear>(beam, q)).norm(), 1e-9 * v.norm()) << k;
  }
}

TEST(BeamKernel, TangentIsTheJacobianOfTheGradient) {
  Random random(2);
  for (int k = 0; k < 200; ++k) {
    const BeamConstants<double> beam = random_beam(random);
    const Pair p = random_pair(random, 3.0);
    const Matrix12 exact = tangent<Corotational>(beam, p, false);
    EXPECT_LT((exact - gradient_slope<Kinematics::corotational>(beam, p)).norm(),
              1e-8 * exact.norm())
        << k;
    const Pair q = random_linear_pair(random);
    const Matrix12 linear = tangent<Linear>(beam, q, false);
    EXPECT_LT((linear - gradient_slope<Kinematics::linear>(beam, q)).norm(), 1e-9 * linear.norm())
        << k;
  }
}

TEST(BeamKernel, SymmetricFormIsTheTangentPlusHalfTheSkewMoments) {
  Random random(3);
  for (int k = 0; k < 200; ++k) {
    const BeamConstants<double> beam = random_beam(random);
    const Pair p = random_pair(random, 3.0);
    const Matrix12 h = tangent<Corotational>(beam, p, true);
    EXPECT_LT((h - h.transpose()).norm(), 1e-13 * h.norm()) << k;
    const Matrix12 expected = tangent<Corotational>(beam, p, false) +
                              0.5 * skew_of_moments(wrenches<Corotational>(beam, p));
    EXPECT_LT((h - expected).norm(), 1e-14 * h.norm()) << k;
    const Matrix12 linear = tangent<Linear>(beam, random_linear_pair(random), true);
    EXPECT_LT((linear - linear.transpose()).norm(), 1e-15 * linear.norm()) << k;
  }
}

/// Displacements of a rigid motion of a beam whose first body rests at x.
Pair rigidly_moved(const BeamConstants<double>& beam, const Vec3<double>& x,
                   const Vec3<double>& turn, const Vec3<double>& shift) {
  Pair p;
  const Quat<double> q = exp_rotation(turn);
  for (std::size_t b = 0; b < 2; ++b) {
    const Vec3<double> rest = b == 0 ? x : x + beam.l0 * beam.rest.e1;
    const Vec3<double> u = rotate(q, rest) - rest + shift;
    double* r = p.state.record(b);
    r[0] = u.x, r[1] = u.y, r[2] = u.z;
    test::put_rotation(p.state, b, q);
  }
  return p;
}

TEST(BeamKernel, RigidMotionOfAnySizeIsFree) {
  Random random(4);
  for (const double turn :
       {1e-9, 0.3, pi / 2, pi - 1e-9, pi, pi + 1e-12, 2 * pi, 3 * pi, 7 * pi + 0.1}) {
    for (const double shift : {0.0, 1.0, 1e3, 1e6}) {
      BeamConstants<double> beam = random_beam(random);
      beam.l0 = 2;
      const double rounding = 1e-15 * (10 + shift);  // of positions [m]
      const Pair p = rigidly_moved(beam, random.vector(5), turn * random.direction(),
                                   shift * random.direction());
      const double ea = beam.kn * beam.l0;
      EXPECT_LT(wrenches<Corotational>(beam, p).norm(), std::min(1e-9, 10 * rounding) * ea)
          << turn << ' ' << shift;
      EXPECT_LT(energy<Corotational>(beam, p), 10 * ea * rounding * rounding)
          << turn << ' ' << shift;
    }
  }
}

TEST(BeamKernel, LinearRigidMotionIsFree) {
  Random random(5);
  const BeamConstants<double> beam = random_beam(random);
  const Vec3<double> t = random.vector(1), turn = random.vector(1);
  Pair p;
  for (std::size_t b = 0; b < 2; ++b) {
    const Vec3<double> u = t + cross(turn, (b == 0 ? 0.0 : beam.l0) * beam.rest.e1);
    double* r = p.state.record(b);
    r[0] = u.x, r[1] = u.y, r[2] = u.z, r[4] = turn.x / 2, r[5] = turn.y / 2, r[6] = turn.z / 2;
  }
  EXPECT_LT(wrenches<Linear>(beam, p).norm(), 1e-14);
}

TEST(BeamKernel, ForcesTurnWithASuperposedRotation) {
  Random random(6);
  for (int k = 0; k < 100; ++k) {
    const BeamConstants<double> beam = random_beam(random);
    const Pair p = random_pair(random, 3.0);
    const Quat<double> turn = random.rotation(k == 0 ? pi : random.uniform(0, 2 * pi));
    Pair turned = p;
    for (std::size_t b = 0; b < 2; ++b) {
      const Vec3<double> rest = b == 0 ? Vec3<double>{0, 0, 0} : beam.l0 * beam.rest.e1;
      const Vec3<double> u = rotate(turn, rest + displacement(p.state, b)) - rest;
      double* r = turned.state.record(b);
      r[0] = u.x, r[1] = u.y, r[2] = u.z;
      test::put_rotation(turned.state, b, product(turn, rotation(p.state, b)));
    }
    const Vector12 before = wrenches<Corotational>(beam, p),
                   after = wrenches<Corotational>(beam, turned);
    for (int at = 0; at < 12; at += 3) {
      const Vec3<double> expected = rotate(turn, {before[at], before[at + 1], before[at + 2]});
      EXPECT_NEAR(after[at], expected.x, 1e-13 * before.norm());
      EXPECT_NEAR(after[at + 1], expected.y, 1e-13 * before.norm());
      EXPECT_NEAR(after[at + 2], expected.z, 1e-13 * before.norm());
    }
    EXPECT_NEAR(energy<Corotational>(beam, turned) / energy<Corotational>(beam, p), 1, 1e-13);
  }
}

TEST(BeamKernel, ForcesAndMomentsBalance) {
  Random random(7);
  for (int k = 0; k < 100; ++k) {
    const BeamConstants<double> beam = random_beam(random);
    const Pair p = random_pair(random, 3.0);
    const Vector12 w = wrenches<Corotational>(beam, p);
    EXPECT_EQ((w.head<3>() + w.segment<3>(6)).norm(), 0);
    const Vec3<double> chord =
        beam.l0 * beam.rest.e1 + (displacement(p.state, 1) - displacement(p.state, 0));
    const Vec3<double> arm = cross(chord, Vec3<double>{w[6], w[7], w[8]});
    const Eigen::Vector3d sum =
        w.segment<3>(3) + w.segment<3>(9) + Eigen::Vector3d(arm.x, arm.y, arm.z);
    EXPECT_LT(sum.norm(), 1e-14 * w.norm());
  }
}

TEST(BeamKernel, OppositeQuaternionsAreTheSameRotation) {
  Random random(8);
  for (int k = 0; k < 20; ++k) {
    const BeamConstants<double> beam = random_beam(random);
    const Pair p = random_pair(random, 3.0);
    for (int signs = 1; signs < 4; ++signs) {
      Pair q = p;
      for (std::size_t b = 0; b < 2; ++b) {
        for (int c = 3; c < 7 && (signs >> b & 1) != 0; ++c) q.state.record(b)[c] *= -1;
      }
      EXPECT_EQ(wrenches<Corotational>(beam, q), wrenches<Corotational>(beam, p));
      EXPECT_EQ(tangent<Corotational>(beam, q, true), tangent<Corotational>(beam, p, true));
    }
  }
}

/// A beam along x with axis 2 = y, and six stiffnesses that cannot be taken for each other.
const BeamConstants<double> straight{
    {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, 2.0, 3.0, 5.0, 7.0, 11.0, 13.0, 17.0};

/// What one strain of size 1e-6 does: wrench on body j over the strain.
template <class Beam>
Vector12 response(const std::array<double, 12>& motion) {
  constexpr double size = 1e-6;
  Pair p;
  for (int k = 0; k < 12; ++k) {
    const auto body = static_cast<std::size_t>(k / 6);
    const double amount = size * motion[static_cast<std::size_t>(k)];
    if (k % 6 < 3 || std::is_same_v<Beam, Corotational>) {
      test::move(p.state, body, k % 6, amount);
    } else {
      p.state.record(body)[1 + k % 6] += amount / 2;
    }
  }
  return wrenches<Beam>(straight, p) / size;
}

template <class Beam>
void each_strain_has_its_stiffness() {
  const auto expect = [](const std::array<double, 12>& motion,
                         const std::array<double, 12>& wrench) {
    EXPECT_LT((response<Beam>(motion) - Eigen::Map<const Vector12>(wrench.data())).norm(), 1e-4);
  };
  // Body j moves along 1, 2, 3; the shear forces' couple Q l is shared by both bodies.
  expect({0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0}, {3, 0, 0, 0, 0, 0, -3, 0, 0, 0, 0, 0});
  expect({0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0}, {0, 5, 0, 0, 0, 5, 0, -5, 0, 0, 0, 5});
  expect({0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0}, {0, 0, 7, 0, -7, 0, 0, 0, -7, 0, -7, 0});
  // Twist and pure bending: half a turn to each side.
  expect({0, 0, 0, -.5, 0, 0, 0, 0, 0, .5, 0, 0}, {0, 0, 0, 11, 0, 0, 0, 0, 0, -11, 0, 0});
  expect({0, 0, 0, 0, -.5, 0, 0, 0, 0, 0, .5, 0}, {0, 0, 0, 0, 13, 0, 0, 0, 0, 0, -13, 0});
  expect({0, 0, 0, 0, 0, -.5, 0, 0, 0, 0, 0, .5}, {0, 0, 0, 0, 0, 17, 0, 0, 0, 0, 0, -17});
  // Both turn alike about 3: the chord is sheared by -l0 against them.
  expect({0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 1}, {0, -10, 0, 0, 0, -10, 0, 10, 0, 0, 0, -10});
}

TEST(BeamKernel, EachStrainHasItsStiffness) {
  each_strain_has_its_stiffness<Corotational>();
  each_strain_has_its_stiffness<Linear>();
}

TEST(BeamKernel, SectionForcesAreTheStrainsTimesTheirStiffnesses) {
  Pair p;
  test::move(p.state, 1, 0, 1e-6), test::move(p.state, 1, 1, 2e-6), test::move(p.state, 1, 2, 3e-6);
  for (const int k : {3, 4, 5})
    test::move(p.state, 0, k, -1e-6 * k), test::move(p.state, 1, k, 1e-6 * k);
  const BeamSection s = Corotational::section(straight, p.i(), p.j());
  const std::array<double, 6> expected{3e-6, 10e-6, 21e-6, 66e-6, 104e-6, 170e-6};
  for (std::size_t k = 0; k < 6; ++k) EXPECT_NEAR(s[k] / expected[k], 1, 1e-4) << k;
}

TEST(BeamKernel, StrainsOfOnePartInATrillionAreSeen) {
  constexpr double tiny = 1e-12;
  Random random(9);
  for (int k = 0; k < 100; ++k) {
    const BeamConstants<double> beam = random_beam(random);
    const std::array<Vec3<double>, 3> axes{beam.rest.e1, beam.rest.e2, beam.rest.e3};
    const std::array<double, 6> stiffness{beam.kn, beam.ksz, beam.ksy, beam.kt, beam.kby, beam.kbz};
    const Quat<double> turn = random.rotation(random.uniform(0, 2 * pi));
    for (std::size_t mode = 0; mode < 6; ++mode) {
      Pair rest;
      if (mode < 3) {
        const Vec3<double> u = (tiny * beam.l0) * axes[mode];
        rest.j()[0] = u.x, rest.j()[1] = u.y, rest.j()[2] = u.z;
      } else {
        test::put_rotation(rest.state, 0, exp_rotation(-0.5 * tiny * axes[mode - 3]));
        test::put_rotation(rest.state, 1, exp_rotation(0.5 * tiny * axes[mode - 3]));
      }
      const double expected = tiny * (mode < 3 ? beam.l0 : 1) * stiffness[mode];
      const double seen = Corotational::section(beam, rest.i(), rest.j())[mode];
      EXPECT_NEAR(seen / expected, 1, mode == 0 ? 1e-10 : 1e-3) << "mode " << mode;
      // After a large rotation of all, displacements are known to 1e-16 l0 and rotations to 1e-16
      // only.
      if (mode < 3) continue;
      Pair turned = rest;
      const Vec3<double> u = rotate(turn, beam.l0 * beam.rest.e1) - beam.l0 * beam.rest.e1;
      turned.j()[0] = u.x, turned.j()[1] = u.y, turned.j()[2] = u.z;
      for (std::size_t b = 0; b < 2; ++b)
        test::put_rotation(turned.state, b, product(turn, rotation(rest.state, b)));
      const double after = Corotational::section(beam, turned.i(), turned.j())[mode];
      EXPECT_NEAR(after / expected, 1, 1e-3) << "mode " << mode;
    }
  }
}

TEST(BeamKernel, RelativeRotationsUpToThreeRadians) {
  for (const double angle : {1e-9, 0.2, 0.201, 1.0, 2.0, 3.0}) {
    for (const int axis : {3, 4, 5}) {
      Pair p;
      test::move(p.state, 0, axis, -angle / 2);
      test::move(p.state, 1, axis, angle / 2);
      const BeamSection s = Corotational::section(straight, p.i(), p.j());
      const double expected = angle * (axis == 3 ? 11 : axis == 4 ? 13 : 17);
      EXPECT_NEAR(s[static_cast<std::size_t>(axis)] / expected, 1, 1e-14) << angle << ' ' << axis;
    }
  }
}

TEST(BeamKernel, LinearIsTheLimitOfSmallMotions) {
  Random random(10);
  const BeamConstants<double> beam = random_beam(random);
  const Pair large = random_linear_pair(random);
  Pair small, small_linear;
  constexpr double size = 1e-7;
  for (std::size_t b = 0; b < 2; ++b) {
    const double* r = large.state.record(b);
    for (int k = 0; k < 3; ++k)
      small.state.record(b)[k] = small_linear.state.record(b)[k] = size * r[k];
    for (int k = 4; k < 7; ++k) small_linear.state.record(b)[k] = size * r[k];
    test::put_rotation(small.state, b,
                       exp_rotation({2 * size * r[4], 2 * size * r[5], 2 * size * r[6]}));
  }
  const Vector12 expected = wrenches<Linear>(beam, small_linear);
  EXPECT_LT((wrenches<Corotational>(beam, small) - expected).norm(), 1e-6 * expected.norm());
  EXPECT_LT(
      (tangent<Corotational>(beam, Pair{}, false) - tangent<Linear>(beam, Pair{}, false)).norm(),
      1e-14);
}

/// (1 - g)/tan^2(phi/4), g = (phi/2)/sin(phi/2), s = sin(phi/4): by the series of asin(s)/(s sqrt(1
/// - s^2)), whose terms have the ratios 2 k/(2 k + 1) s^2, to the last bit below 0.5, by its closed
/// form above.
Real reference_remainder(Real s) {
  const Real cosine = std::sqrt((1 - s) * (1 + s));
  if (s > 0.5L) return (1 - std::atan2(s, cosine) / (s * cosine)) * (cosine / s) * (cosine / s);
  Real sum = 0, term = 2.0L / 3;  // term of s^(2 k), over s^2
  for (int k = 1; k < 200; ++k) {
    sum += term;
    term *= s * s * (2 * k + 2) / (2 * k + 3);
  }
  return -(1 - s * s) * sum;
}

TEST(BetweenEnds, SeriesAndClosedFormsAgreeAtTheSwitch) {
  const Real at_switch = 0.05L;  // |b - a|^2 = 4 s^2 = series_limit
  test::Random random(4);
  for (const Real s : {1e-150L, 1e-9L, 1e-3L, 0.02L, 0.0499L, at_switch * (1 - 1e-15L),
                       at_switch * (1 + 1e-15L), 0.0501L, 0.15L, 0.3L, 0.6L, 0.7L, 0.707L}) {
    const Real half_cosine = 1 - 2 * s * s, half_sine = 2 * s * std::sqrt((1 - s) * (1 + s));
    const Vec3<double> axis = random.direction();
    const Quat<double> a{1, 0, 0, 0};
    const Quat<double> b{double(half_cosine), double(half_sine * axis.x),
                         double(half_sine * axis.y), double(half_sine * axis.z)};
    for (const double sign : {1.0, -1.0}) {
      if (half_cosine < 1e-9L && sign < 0) continue;  // half a turn: both ways are as long
      const Between<double> seen =
          between(a, Quat<double>{sign * b.w, sign * b.x, sign * b.y, sign * b.z});
      EXPECT_EQ(seen.b.x, b.x) << double(s);
      EXPECT_NEAR(seen.square / double(4 * s * s), 1, 2e-15) << double(s);
      EXPECT_NEAR(seen.h / double(reference_remainder(s)), 1, s < at_switch ? 1e-15 : 3e-13)
          << double(s);
    }
  }
}

TEST(BeamStiffness, ShearVariantsByTheirFormulas) {
  Beams b;
  b.bodies = {{0, 1}};
  const double e = 4e9, g = 1.5e9, kappa = 0.8, w = 0.7, h = 1.1, l = 1.9, torsion = 0.05;
  const double area = w * h, iy = w * h * h * h / 12, iz = h * w * w * w / 12;
  b.area = {area}, b.inertia_y = {iy}, b.inertia_z = {iz}, b.torsion = {torsion}, b.length = {l};
  b.young = {e}, b.shear_modulus = {g}, b.shear_factor = {kappa};
  const auto exact = [&](double inertia) {
    const double phi = 12 * e * inertia / (kappa * g * area * l * l);
    return 12 * e * inertia / (l * l * l * (1 + phi));
  };
  const auto near = [](double seen, double expected) { EXPECT_NEAR(seen / expected, 1, 1e-14); };
  for (const Shear shear : {Shear::one_point, Shear::exact, Shear::none}) {
    const BeamStiffness k = beam_stiffness(b, 0, shear);
    near(k.kn, e * area / l), near(k.kt, g * torsion / l);
    near(k.kby, e * iy / l), near(k.kbz, e * iz / l);
    // Along axis 2 the beam bends about axis 3.
    near(k.ksz, shear == Shear::one_point ? kappa * g * area / l
                : shear == Shear::exact   ? exact(iz)
                                          : 12 * e * iz / (l * l * l));
    near(k.ksy, shear == Shear::one_point ? kappa * g * area / l
                : shear == Shear::exact   ? exact(iy)
                                          : 12 * e * iy / (l * l * l));
  }
}

TEST(BeamStiffness, ShearAlongAxis2MayHaveAFactorOfItsOwn) {
  Beams b;
  b.bodies = {{0, 1}};
  const double e = 4e9, g = 1.5e9, along_2 = 0.3, along_3 = 0.8, area = 0.6, iz = 0.04, l = 1.9;
  b.area = {area}, b.inertia_y = {0.07}, b.inertia_z = {iz}, b.torsion = {0.05}, b.length = {l};
  b.young = {e}, b.shear_modulus = {g}, b.shear_factor = {along_3};
  b.shear_factor_y = {along_2};
  const BeamStiffness k = beam_stiffness(b, 0, Shear::one_point);
  EXPECT_NEAR(k.ksz / (along_2 * g * area / l), 1, 1e-14);
  EXPECT_NEAR(k.ksy / (along_3 * g * area / l), 1, 1e-14);
  const double bending = 12 * e * iz / (l * l * l), shear = along_2 * g * area / l;
  EXPECT_NEAR(beam_stiffness(b, 0, Shear::exact).ksz * (1 / bending + 1 / shear), 1, 1e-14);
}

}  // namespace
}  // namespace floe
