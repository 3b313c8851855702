// The law of one contact, term by term (model.md, "Contact"): signs, factors, axes.

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <random>
#include <variant>

#include "contact_laws/laws.h"

namespace floe {
namespace {

constexpr double tolerance = 1e-12;

void expect_vector(const Vec3<double>& a, const Vec3<double>& b, double scale = 1) {
  EXPECT_NEAR(a.x, b.x, tolerance * scale);
  EXPECT_NEAR(a.y, b.y, tolerance * scale);
  EXPECT_NEAR(a.z, b.z, tolerance * scale);
}

/// An overlap whose facets on B have the area vector `area`.
Overlap overlap_of(double volume, const Vec3<double>& area, const Vec3<double>& moment = {}) {
  Overlap o;
  o.volume = volume;
  o.area = area;
  o.moment = moment;
  return o;
}

struct Law {
  ContactOptions options{.law = ContactLaw::overlap, .young = 1, .friction = 0.5};
  PairConstants pair{.stiffness = 1e6, .area = 4, .friction = 0.5};
  Mobility mobility{.a = {.mass = 0.1}};  // 10 kg against an obstacle
  PairHistory memory;
  RelativeMotion motion;
  LastStep last;
  Vec3<double> mean_spin{};
  bool newly_eligible = false;
  StoredEnergy stored;  ///< by the last contact
  PairHistory history;  ///< after the last contact
  ContactForce operator()(const Overlap& o) {
    return std::visit(
        [&](const auto& law) {
          ContactTrial trial;
          find_trial(law, pair, o, 0, motion, mobility, last, mean_spin, memory, newly_eligible,
                     trial);
          const ContactForce force =
              options.damping_ratio > 0 ? with_dashpots(trial, motion) : without_dashpots(trial);
          stored = stored_energy(law, trial, force.springs);
          history = history_of(trial, force.springs);
          return force;
        },
        law_of(options));
  }
  PairHistory after(const Overlap& o) {
    (void)(*this)(o);
    return history;
  }
};

TEST(ContactLaw, NormalForceIsStiffnessTimesVolumeAlongTheArea) {
  Law law;
  const ContactForce c = law(overlap_of(0.01, {0, 0, -2}, {3, 0, 0}));
  expect_vector(c.force(), {0, 0, -1e4}, 1e4);
  expect_vector(c.couple, {0, 0, 0});
  EXPECT_NEAR(law.stored.normal, 0.5 * 1e6 * 0.01 * 0.01 / 2, tolerance);
}

TEST(ContactLaw, PotentialGivesAPressureAndItsCouple) {
  Law law;
  law.options.law = ContactLaw::potential;
  const ContactForce c = law(overlap_of(0.01, {0, -2, 0}, {0, 0.3, -0.1}));
  const double pressure = 1e6 / 4 * 0.01;
  expect_vector(c.force(), {0, -2 * pressure, 0}, pressure);
  expect_vector(c.couple, {0, 0.3 * pressure, -0.1 * pressure}, pressure);
  EXPECT_NEAR(law.stored.normal, 0.5 * 1e6 / 4 * 0.01 * 0.01, tolerance);
  // Crushed to p |S| = sigma_p |S|: V - V_p = sigma_p A_r/k_v.
  law.options.plastic_limit.pressure = 1000;
  const ContactForce crushed = law(overlap_of(0.01, {0, -2, 0}));
  expect_vector(crushed.force(), {0, -2000, 0}, 2000);
  EXPECT_NEAR(law.history.plastic, 0.01 - 1000 * 4 / 1e6, tolerance);
}

TEST(ContactLaw, ViscousTermResistsApproachAndNeverPulls) {
  Law law;
  law.options.damping_ratio = 0.2;
  law.motion.velocity = {7, 0, -0.1};  // B's face looks up: A comes down
  const Overlap o = overlap_of(0.01, {0, 0, 2});
  const double viscous = 2 * 0.2 * std::sqrt(10 * 1e6 * 2) * 0.1;
  EXPECT_NEAR(law(o).force().z, 1e4 + viscous, tolerance * 1e4);
  law.motion.velocity = {7, 0, 0.1};
  EXPECT_NEAR(law(o).force().z, 1e4 - viscous, tolerance * 1e4);
  law.motion.velocity = {7, 0, 100};
  EXPECT_EQ(law(o).force().z, 0);
  law.motion.velocity = {7, 0, -100};
  law.options.plastic_limit.pressure = 6000;  // of both terms together
  EXPECT_NEAR(law(o).force().z, 12000, tolerance * 1e4);
}

TEST(ContactLaw, BornContactHasItsOverlapAsPlastic) {
  Law law;
  law.newly_eligible = true;
  const ContactForce c = law(overlap_of(0.01, {0, 0, 2}));
  expect_vector(c.force(), {0, 0, 0});
  EXPECT_EQ(law.history.plastic, 0.01);
  EXPECT_EQ(law.stored.normal, 0);
}

TEST(ContactLaw, FrictionOpposesSlipAndTurnsWithTheMeanSpin) {
  Law law;
  (void)law.after(overlap_of(0.01, {0, 0, 2}));
  EXPECT_NEAR(law.history.springs.stiffness, 0.6 * 1e6 * 2, tolerance * 1e6);
  const double dt = 1e-3;
  // What A moves along the normal does not count.
  law.last.dt = dt;
  law.motion.velocity = {0.3, -0.4, 5};
  expect_vector(law.after(overlap_of(0.01, {0, 0, 2})).springs.force, {-360, 480, 0}, 1e3);
  law.motion = {};
  law.memory.springs = {.stiffness = law.history.springs.stiffness, .force = {100, 0, 0}};
  law.mean_spin = {3, 4, 20};
  const double turn = 20 * dt;
  expect_vector(law.after(overlap_of(0.01, {0, 0, 2})).springs.force,
                {100 * std::cos(turn), 100 * std::sin(turn), 0}, 100);
}

TEST(ContactLaw, StoredFrictionTurnsWithTheNormalAndFallsWithTheStiffness) {
  Law law;
  law.memory.springs.force = {100, 20, 0};  // under a normal along z
  law.memory.springs.stiffness = 0.6 * 1e6 * 2;
  const double tilt = 0.3, size = std::hypot(100, 20);
  const Vec3<double> normal{std::sin(tilt), 0, std::cos(tilt)};
  const Vec3<double> f = law(overlap_of(0.01, 2.0 * normal)).springs.force;
  EXPECT_NEAR(dot(f, normal), 0, tolerance * size);
  EXPECT_NEAR(std::sqrt(dot(f, f)), size, tolerance * size);
  // Its part in the new plane, lengthened.
  const Vec3<double> in_plane{100 * std::cos(tilt) * std::cos(tilt), 20,
                              -100 * std::cos(tilt) * std::sin(tilt)};
  expect_vector(f, (size / std::sqrt(dot(in_plane, in_plane))) * in_plane, size);
  // Half of the area, half of the force; more area, no more force.
  expect_vector(law.after(overlap_of(0.01, {0, 0, 1})).springs.force, {50, 10, 0}, size);
  expect_vector(law.after(overlap_of(0.01, {0, 0, 8})).springs.force, {100, 20, 0}, size);
}

TEST(ContactLaw, FrictionIsCutToTheCoefficientTimesTheNormalForce) {
  Law law;
  law.memory.springs.force = {3e4, -4e4, 0};
  law.memory.springs.stiffness = 1;
  const Overlap o = overlap_of(0.01, {0, 0, 2});
  expect_vector(law.after(o).springs.force, {3000, -4000, 0}, 5e3);
  law.options.plastic_limit.pressure = 1000;  // of the normal force that acts
  expect_vector(law.after(o).springs.force, {600, -800, 0}, 1e3);
  law.pair.friction = 0;
  expect_vector(law.after(o).springs.force, {0, 0, 0});
}

/// A face of 1 m along x and 2 m along y.
Overlap face_of(double volume) {
  Overlap o = overlap_of(volume, {0, 0, 2});
  o.patch = {
      .area = 2, .u = {1, 0, 0}, .v = {0, 1, 0}, .uu = 2.0 / 12, .vv = 8.0 / 12, .reach = 1.2};
  return o;
}

TEST(ContactLaw, ViscousPressureResistsRocking) {
  Law law;
  law.options.damping_ratio = 0.2;
  const double c = 2 * 0.2 * std::sqrt(10 * 1e6 * 2);
  law.motion.spin = {0.1, 0, 0};  // sides go up and down over y
  expect_vector(law(face_of(0.01)).whole_couple(), {-0.1 * c / 2 * 8 / 12, 0, 0}, 100);
  law.motion.spin = {0, -0.1, 0};
  const ContactForce rocks = law(face_of(0.01));
  expect_vector(rocks.viscous_couple, {0, 0.1 * c / 2 * 2 / 12, 0}, 100);
  EXPECT_EQ(rocks.viscous, 0);
  // It is at most what the force can carry over the face: its largest arm is sqrt(8/12/2).
  law.motion.spin = {1e6, 0, 0};
  expect_vector(law(face_of(0.01)).viscous_couple, {-1e4 * std::sqrt(1 / 3.0), 0, 0}, 1e4);
  // It ends with the force.
  law.motion.velocity = {0, 0, 100};
  expect_vector(law(face_of(0.01)).whole_couple(), {0, 0, 0});
}

/// The spin of a body that comes to rest falls by a part in every step, below any number.
TEST(ContactLaw, RockingThatDiesAwayLeavesNumbers) {
  Law law;
  law.options.damping_ratio = 0.2;
  for (const double spin : {1e-70, 1e-76, 1e-80, 1e-81, 1e-82, 1e-100, 1e-160, 1e-300}) {
    law.motion.spin = {spin, 0, 0};
    const Vec3<double> couple = law(face_of(0.01)).viscous_couple;
    EXPECT_TRUE(std::isfinite(couple.x)) << spin;
    EXPECT_LE(couple.x, 0) << spin;
  }
}

/// The dashpot sees the velocity at the middle of the facets and acts there.
TEST(ContactLaw, ViscousForceActsAtTheMiddleOfTheFacets) {
  Law law;
  law.options.damping_ratio = 0.2;
  const double c = 2 * 0.2 * std::sqrt(10 * 1e6 * 2);
  Overlap o = face_of(0.01);
  o.patch.middle = {0, 0.1, 0};
  law.motion.spin = {0.05, 0, 0};  // the middle goes up by 0.005 m/s
  const ContactForce contact = law(o);
  EXPECT_NEAR(contact.viscous, -c * 0.005, 1e-9 * c);
  expect_vector(contact.viscous_couple, {-0.05 * c / 2 * 8 / 12 - 0.1 * c * 0.005, 0, 0}, 1e3);
}

TEST(ContactLaw, FrictionResistsSpinAboutTheNormal) {
  Law law;
  law.last.dt = 1e-3;
  law.motion.spin = {3, 0, 2};
  const double stiffness = 0.6 * 1e6 * (2 + 8) / 12;  // k_t tr(J2)/|S| [N m]
  const ContactForce c = law(face_of(0.01));
  EXPECT_NEAR(law.history.twist.stiffness, stiffness, tolerance * stiffness);
  EXPECT_NEAR(law.history.twist.couple, -stiffness * 2e-3, tolerance * stiffness);
  expect_vector(c.whole_couple(), {0, 0, -stiffness * 2e-3}, 1e3);
  EXPECT_NEAR(law.stored.tangential, 0.5 * stiffness * 4e-6, tolerance);
  law.motion.spin = {0, 0, 2000};  // to mu F_n r_eff = 0.5 1e4 1.2/2
  EXPECT_NEAR(law(face_of(0.01)).whole_couple().z, -3000, 1e-9);
}

/// Dashpots act on velocities at t_n that they slow down themselves, and in the first step of a
/// touch for the time since the touch and half a step.
TEST(ContactLaw, DashpotIsImplicitAndCountsFromTheTouch) {
  Law law;
  law.options.damping_ratio = 0.2;
  law.motion.velocity = {0, 0, -0.1};
  law.last = {.dt = 1e-3, .touched = true};
  const double c = 2 * 0.2 * std::sqrt(10 * 1e6 * 2), slow = 1 + 0.5e-3 * c / 10;
  EXPECT_NEAR(law(face_of(0.01)).viscous, c * 0.1 / slow, 1e-9 * c);
  law.last.touched = false;  // 5e-5 m deep at 0.1 m/s: half a step ago
  EXPECT_NEAR(law(face_of(1e-4)).viscous, c * 0.1 / slow, 1e-9 * c);
  EXPECT_NEAR(law(face_of(0.01)).viscous, 1.5 * c * 0.1 / slow, 1e-9 * c);  // a whole step ago
  EXPECT_NEAR(law(face_of(1e-5)).viscous, 0.55 * c * 0.1 / slow, 1e-9 * c);
}

TEST(ContactLaw, EffectiveMassIsThatOfBothBodiesAtThePoint) {
  const Triad<double> upright = triad(Quat<double>{1, 0, 0, 0}),
                      turned = triad(exp_rotation({0, 0, 0.5 * std::acos(-1.0)}));
  const Mobility mobility{
      .a = {.mass = 0.5, .turning = SymmetricMatrix::along(upright, {2, 3, 5})},
      .b = {.mass = 0.25, .turning = SymmetricMatrix::along(turned, {7, 11, 13})},
      .apart = {0, 0, 4}};
  // Along z at (0.1, 0.2, -2) from A, (0.1, 0.2, 2) from B: r x d = (0.2, -0.1, 0); x of B's own
  // axes is along the world's y.
  const double expected = 0.75 + 2 * 0.04 + 3 * 0.01 + 7 * 0.01 + 11 * 0.04;
  EXPECT_NEAR(mobility.along({0.1, 0.2, -2}, {0, 0, 1}), expected, tolerance);
  EXPECT_NEAR((mobility.turning() * Vec3<double>{0, 1, 0}).y, 3 + 7, tolerance);
  EXPECT_NEAR(mobility.along({0.1, 0.2, -2}, {1, 0, 0}),
              0.75 + 3 * 4 + 5 * 0.04 + 7 * 4 + 13 * 0.04, tolerance);
  // The mean over the directions across one that is not along an axis.
  const Vec3<double> r{0.1, 0.2, -2}, d{0.6, 0, 0.8}, u{0, 1, 0}, v{0.8, 0, -0.6};
  EXPECT_NEAR(mobility.across(r, d), 0.5 * (mobility.along(r, u) + mobility.along(r, v)),
              tolerance * 100);
}

/// ISO 19906: 7.4 A^-0.7 MPa up to 10 m^2, 1.48 MPa above.
TEST(ContactLaw, PlasticLimitFallsWithTheArea) {
  Law law;
  law.pair.stiffness = 1e12;
  PlasticLimit& limit = law.options.plastic_limit;
  limit = {.pressure = 7.4e6, .exponent = 0.7, .least = 1.48e6, .most = 30e6};
  for (const double area : {0.01, 0.3, 1.0, 2.0, 9.0, 20.0}) {
    const double expected = area < 0.1 ? 30e6 : area < 9.5 ? 7.4e6 * std::pow(area, -0.7) : 1.48e6;
    EXPECT_NEAR(law(overlap_of(0.01, {0, 0, area})).elastic, expected * area,
                1e-9 * expected * area)
        << area;
  }
  limit.area = 4;  // p0 holds for this area
  EXPECT_NEAR(law(overlap_of(0.01, {0, 0, 4})).elastic, 7.4e6 * 4, 1);
  EXPECT_NEAR(law(overlap_of(0.01, {0, 0, 8})).elastic, 7.4e6 * 8 / std::pow(2, 0.7), 1);
}

/// s(v) = s_inf + (s_0 - s_inf) exp(-v/v_r) of the speed of approach.
TEST(ContactLaw, PlasticLimitFallsWithTheSpeedOfApproach) {
  Law law;
  law.pair.stiffness = 1e12;
  law.options.plastic_limit = {.pressure = 2e6, .fast = 0.5, .speed = 0.05};
  const auto force = [&](double approach) {
    law.motion.velocity = {3, 0, -approach};
    return law(overlap_of(0.01, {0, 0, 2})).elastic;
  };
  EXPECT_NEAR(force(0), 4e6, 1e-5);
  EXPECT_NEAR(force(-0.1), 4e6, 1e-5);
  EXPECT_NEAR(force(0.05), 2e6 * (1 + std::exp(-1)), 1e-5);
  EXPECT_NEAR(force(0.1), 2e6 * (1 + std::exp(-2)), 1e-5);
  EXPECT_NEAR(force(10), 2e6, 1e-5);
}

/// The energy of `overlap` on a half-space is the integral of k_v (V - V_p) over the depth: for
/// V = b x^p from x_p to x, k_v b [(x^(p+1) - x_p^(p+1))/(p + 1) - x_p^p (x - x_p)]. It does not
/// jump when crushing begins.
TEST(ContactLaw, StoredEnergyIsTheWorkThatComesBack) {
  constexpr double b = 0.7, x = 0.02;
  for (const int p : {1, 2, 3}) {
    Overlap o = overlap_of(b * std::pow(x, p), {0, 0, p * b * std::pow(x, p - 1)});
    for (const double share : {0.0, 1e-12, 0.3, 0.9, 1.0}) {
      const double from = share * x;
      const double expected = b * ((std::pow(x, p + 1) - std::pow(from, p + 1)) / (p + 1) -
                                   std::pow(from, p) * (x - from));
      EXPECT_NEAR(
          OverlapLaw::stored_volume(o.volume, length(o.area), x / (p + 1), b * std::pow(from, p)),
          expected, 1e-10 * b * std::pow(x, p + 1))
          << p << " " << share;
    }
  }
}

TEST(ContactLaw, HistoryGoesThroughACheckpoint) {
  const PairHistory memory{.plastic = 1,
                           .springs = {.stiffness = 2, .force = {3, 4, 5}},
                           .twist = {.stiffness = 6, .couple = 7}};
  const auto numbers = memory.as_numbers();
  EXPECT_EQ(PairHistory::from(numbers).as_numbers(), numbers);
  EXPECT_EQ(numbers, (std::array<double, 7>{1, 2, 3, 4, 5, 6, 7}));
}

/// All that a contact depends on, of doubles or of lanes.
template <class T>
struct SituationOf {
  PairConstantsOf<T> pair;
  OverlapOf<T> overlap;
  T depth;
  RelativeMotionOf<T> motion, predicted;
  MobilityOf<T> mobility;
  Vec3<T> mean_spin;
  PairHistoryOf<T> memory;
  T touched, newly_eligible;
};

/// What comes of it.
template <class T>
struct OutcomeOf {
  ContactTrialOf<T> trial;
  ContactForceOf<T> bare, damped;

  OutcomeOf() = default;
  OutcomeOf(const auto& law, const SituationOf<T>& s) {
    find_trial(law, s.pair, s.overlap, s.depth, s.motion, s.mobility,
               {.dt = 1e-3, .touched = s.touched != 0.0}, s.mean_spin, s.memory,
               s.newly_eligible != 0.0, trial);
    bare = without_dashpots(trial);
    damped = with_dashpots(trial, s.predicted);
  }
};

/// A contact at random: some without area, springs, friction or motion, some that crush or part.
SituationOf<double> at_random(std::mt19937_64& random) {
  std::uniform_real_distribution<double> about(-1, 1);
  std::bernoulli_distribution rarely(0.2);
  std::array<double, numbers_of<SituationOf>> numbers;
  for (double& x : numbers) x = rarely(random) ? 0.0 : about(random);
  auto s = std::bit_cast<SituationOf<double>>(numbers);
  for (double* positive :
       {&s.pair.stiffness, &s.pair.area, &s.overlap.volume, &s.mobility.a.mass,
        &s.mobility.a.turning.xx, &s.mobility.a.turning.yy, &s.mobility.a.turning.zz})
    *positive = std::abs(*positive) + 0.1;
  for (double* not_negative :
       {&s.pair.friction, &s.overlap.patch.area, &s.overlap.patch.uu, &s.overlap.patch.vv,
        &s.overlap.patch.reach, &s.memory.plastic, &s.memory.springs.stiffness,
        &s.memory.twist.stiffness, &s.mobility.b.mass})
    *not_negative = std::abs(*not_negative);
  s.mobility.a.turning.xy = s.mobility.a.turning.xz = s.mobility.a.turning.yz = 0;
  s.mobility.b.turning = {};
  if (rarely(random)) s.overlap.area = {};
  s.pair.half_space = 0;
  for (double* yes_or_no : {&s.touched, &s.newly_eligible}) *yes_or_no = rarely(random) ? 1 : 0;
  return s;
}

/// Contacts in lanes have the bits of each alone, for both laws and with every term.
TEST(ContactLaw, LanesAreTheScalarForm) {
  std::mt19937_64 random(1);
  for (const ContactLaw word : {ContactLaw::overlap, ContactLaw::potential}) {
    const ContactLaws law = law_of(
        {.law = word, .damping_ratio = 0.3, .plastic_limit = {.pressure = 0.3, .exponent = 0.5}});
    for (int k = 0; k < 2000; ++k) {
      std::array<SituationOf<double>, lanes> alone;
      for (auto& s : alone) s = at_random(random);
      const auto together = gathered<SituationOf>([&](std::size_t lane) { return &alone[lane]; });
      std::visit(
          [&](const auto& of) {
            const OutcomeOf<Lanes> all(of, together);
            for (std::size_t lane = 0; lane < lanes; ++lane) {
              using Bits = std::array<std::uint64_t, numbers_of<OutcomeOf>>;
              const OutcomeOf<double> one(of, alone[lane]);
              ASSERT_EQ(std::bit_cast<Bits>(one_lane<OutcomeOf>(all, lane)),
                        std::bit_cast<Bits>(one))
                  << k << " " << lane;
            }
          },
          law);
    }
  }
}

}  // namespace
}  // namespace floe
