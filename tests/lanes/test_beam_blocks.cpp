// Wrenches of a block of beams, one beam per lane, against the kernel in longer numbers; every lane
// and every place of a body in a block gets the same bits.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "beams/lanes.h"
#include "support/random.h"

namespace floe {
namespace {

using test::Random;
using Real = long double;

/// A block of beams between few bodies, so that each has several. No chord is shorter than half its
/// length at rest: forces of a beam that is squeezed to a point grow without bound.
template <template <class> class Frame>
struct Case {
  static constexpr std::size_t bodies = 5;
  using Scalar = typename BeamBlock<Frame>::Scalar;
  std::vector<Scalar> beams;
  BeamBlock<Frame> block{};
  DashpotBlock dashpots{};
  State<Spatial> state{bodies};

  Case(Random& random, double turn) {
    for (std::size_t b = 0; b < bodies; ++b) {
      const Vec3<double> u = random.vector(0.05), v = random.vector(1), w = random.vector(1);
      const Quat<double> q = random.rotation(random.uniform(0, turn));
      const std::array<double, 13> all{u.x, u.y, u.z, q.w, q.x, q.y, q.z,
                                       v.x, v.y, v.z, w.x, w.y, w.z};
      std::copy(all.begin(), all.end(), state.record(b));
    }
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      const auto number = [&] { return random.uniform(0.5, 2); };
      beams.push_back(
          {frame(random), number(), number(), number(), number(), number(), number(), number()});
      const BeamStiffness c{number(), number(), number(), number(), number(), number()};
      put(lane, lane, c);
    }
  }
  static auto frame(Random& random) {
    if constexpr (std::is_same_v<Frame<double>, EccentricFrame<double>>) {
      const AnyFrame<double> rest = Case<AnyFrame>::frame(random);
      return EccentricFrame<double>{rest, random.vector(0.3), random.vector(0.3)};
    } else {
      return triad_of(random);
    }
  }
  static AnyFrame<double> triad_of(Random& random) {
    const double angle = random.uniform(-3, 3);
    const Vec3<double> e1{std::cos(angle), std::sin(angle), 0}, up{0, 0, 1};
    const AnyFrame<double> flat{e1, cross(up, e1), up};
    if constexpr (std::is_same_v<Frame<double>, FlatFrame<double>>) {
      return flat;
    } else {
      const Triad<double> turn = triad(random.rotation(random.uniform(0, 3)));
      return {turn.to_world(flat.e1), turn.to_world(flat.e2), turn.to_world(flat.e3)};
    }
  }
  /// Beam k at a lane.
  void put(std::size_t lane, std::size_t k, const BeamStiffness& c) {
    block.set(lane, beams[k]);
    block.i[lane] = static_cast<std::int32_t>(k % bodies);
    block.j[lane] = static_cast<std::int32_t>((k + 1 + k / bodies) % bodies);
    dashpots.set(lane, c, true);
  }
};

using Values = std::vector<double>;

template <Kinematics kinematics, bool damped, template <class> class Frame>
Values wrenches(const Case<Frame>& c, double* lost = nullptr) {
  Values values(Case<Frame>::bodies * Spatial::wrench, 0.0);
  const Lanes power =
      add_block<kinematics, damped>(c.block, &c.dashpots, c.state.records.data(), values.data());
  if (lost != nullptr) *lost = reduce(power);
  return values;
}

Vec3<Real> three(const double* p) { return {p[0], p[1], p[2]}; }

/// The same beam by beam, in longer numbers.
template <Kinematics kinematics, bool damped, template <class> class Frame>
std::vector<Real> expected(const Case<Frame>& c, Real& lost) {
  using Kernel = BeamKernel<kinematics>;
  std::vector<Real> values(Case<Frame>::bodies * Spatial::wrench, 0.0L);
  for (std::size_t lane = 0; lane < lanes; ++lane) {
    const auto i = static_cast<std::size_t>(c.block.i[lane]),
               j = static_cast<std::size_t>(c.block.j[lane]);
    const double *ri = c.state.record(i), *rj = c.state.record(j);
    const auto& b = c.beams[lane];
    const auto real = [](const Vec3<double>& v) { return Vec3<Real>{v.x, v.y, v.z}; };
    ScalarConstants<Real, Frame> beam{{}, b.l0, b.kn, b.ksz, b.ksy, b.kt, b.kby, b.kbz};
    beam.rest.e1 = real(b.rest.e1), beam.rest.e2 = real(b.rest.e2), beam.rest.e3 = real(b.rest.e3);
    if constexpr (Kernel::template is_eccentric<decltype(beam)>) {
      beam.rest.offset_i = real(b.rest.offset_i);
      beam.rest.offset_j = real(b.rest.offset_j);
    }
    const BeamStrains<Real> s =
        Kernel::strains(beam, three(rj) - three(ri), Quat<Real>{ri[3], ri[4], ri[5], ri[6]},
                        Quat<Real>{rj[3], rj[4], rj[5], rj[6]});
    BeamStress<Real> stress = elastic_stress(beam, s);
    if constexpr (damped) {
      const BeamStress<Real> rate =
          Kernel::rates(beam, s, three(rj + 7) - three(ri + 7), three(ri + 10), three(rj + 10));
      const BeamStress<Real> viscous = viscous_stress(c.dashpots.get(lane), rate);
      lost +=
          viscous.n * rate.n + viscous.qy * rate.qy + viscous.qz * rate.qz + dot(viscous.c, rate.c);
      stress = stress + viscous;
    }
    const BeamGradient<Real> g = Kernel::gradient(beam, s, stress);
    const auto add = [&](std::size_t body, Real sign, const Vec3<Real>& moment) {
      Real* w = values.data() + body * Spatial::wrench;
      w[0] += sign * g.force.x, w[1] += sign * g.force.y, w[2] += sign * g.force.z;
      w[3] -= moment.x, w[4] -= moment.y, w[5] -= moment.z;
    };
    add(i, 1, g.moment_i);
    add(j, -1, g.moment_j);
  }
  return values;
}

// Stiffnesses, lengths and strains are of order 1; a wrench sums up to some 5 shares of some 200
// operations each, few of which lose digits.
constexpr double rounding_of_a_wrench = 100 * 2.2e-16;

template <Kinematics kinematics, bool damped, template <class> class Frame>
void compare(double turn) {
  Random random(5);
  for (int repeat = 0; repeat < 200; ++repeat) {
    const Case<Frame> c(random, turn);
    double lost = 0;
    Real exact_lost = 0;
    const Values found = wrenches<kinematics, damped>(c, &lost);
    const std::vector<Real> exact = expected<kinematics, damped>(c, exact_lost);
    for (std::size_t k = 0; k < found.size(); ++k)
      EXPECT_NEAR(found[k], static_cast<double>(exact[k]), rounding_of_a_wrench) << "number " << k;
    EXPECT_NEAR(lost, static_cast<double>(exact_lost), lanes * rounding_of_a_wrench);
  }
}

TEST(BeamBlocks, AreTheKernelInLanes) {
  for (const double turn : {1e-3, 0.05, 1.5}) {  // series only; both forms; closed forms as a rule
    compare<Kinematics::corotational, false, AnyFrame>(turn);
    compare<Kinematics::corotational, false, FlatFrame>(turn);
    compare<Kinematics::corotational, true, AnyFrame>(turn);
    compare<Kinematics::corotational, true, FlatFrame>(turn);
    compare<Kinematics::corotational, true, EccentricFrame>(turn);
  }
  compare<Kinematics::linear, false, AnyFrame>(0.05);
  compare<Kinematics::linear, true, FlatFrame>(0.05);
  compare<Kinematics::linear, true, EccentricFrame>(0.05);
}

/// A beam alone in its block, at this lane: nothing stands in the others.
template <template <class> class Frame>
Case<Frame> alone(const Case<Frame>& from, std::size_t beam, std::size_t at) {
  Case<Frame> c = from;
  const std::array<double, 6> k = [&] {
    std::array<double, 6> all{};
    for (std::size_t n = 0; n < 6; ++n) all[n] = from.dashpots.values[n][beam];
    return all;
  }();
  for (std::size_t lane = 0; lane < lanes; ++lane) {
    auto none = c.beams[lane];
    none.kn = none.ksz = none.ksy = none.kt = none.kby = none.kbz = 0;
    c.block.set(lane, none);
    c.dashpots.set(lane, {}, false);
  }
  c.put(at, beam, {k[0], k[1], k[2], k[3], k[4], k[5]});
  return c;
}

template <template <class> class Frame>
void place_does_not_matter() {
  Random random(6);
  constexpr Kinematics kinematics = Kinematics::corotational;
  for (int repeat = 0; repeat < 50; ++repeat) {
    const Case<Frame> c(random, 0.1);
    Values sum(Case<Frame>::bodies * Spatial::wrench, 0.0);
    for (std::size_t beam = 0; beam < lanes; ++beam) {
      const Values share = wrenches<kinematics, true>(alone(c, beam, 0));
      for (std::size_t lane = 1; lane < lanes; ++lane)
        EXPECT_EQ((wrenches<kinematics, true>(alone(c, beam, lane))), share) << "lane " << lane;
      for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += share[k];
    }
    // Shares are added in the order of the beams.
    EXPECT_EQ((wrenches<kinematics, true>(c)), sum);
  }
}

TEST(BeamBlocks, GiveTheSameBitsWhateverTheLane) {
  place_does_not_matter<AnyFrame>();
  place_does_not_matter<FlatFrame>();
  place_does_not_matter<EccentricFrame>();
}

}  // namespace
}  // namespace floe
