// The law of fracture on one beam: strengths, dissipated energies, irreversibility.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "fracture_laws/strengths.h"
#include "support/force_checks.h"
#include "support/one_beam.h"
#include "support/record.h"

namespace floe {
namespace {

constexpr double length = 0.05, w = 0.3, h = 0.2, area = w * h, young = 4e9, shear = young / 2.6;
constexpr double iy = w * h * h * h / 12, iz = h * w * w * w / 12;

FractureOptions options(bool dynamic = true) {
  FractureOptions o;
  o.propagation = Propagation::strength;  // a single beam has no cracks
  o.tensile_strength = 6e5, o.shear_strength = 5e5;
  o.energy = 15, o.energy_shear = 25;
  o.dynamic = dynamic;
  return o;
}

/// A mode of straining that reaches the strength at 1 times its strains, by the formulas of section
/// stresses.
struct Mode {
  const char* name;
  test::Strain at_strength;
  double nominal;  ///< G A [J]
};

double torsion_stress(double moment) {
  const double a = std::max(w, h), b = std::min(w, h);
  return moment * (3 + 1.8 * b / a) / (a * b * b);
}

std::vector<Mode> modes() {
  const auto o = options();
  const double one_point = 5.0 / 6 * shear * area / length;
  const double twist = shear * saint_venant_torsion(w, h) / length;
  test::Strain tension, bend_y, bend_z, shear_y, shear_z, torsion;
  tension.delta = o.tensile_strength * length / young;
  bend_y.psi.y = o.tensile_strength * (w * h * h / 6) * length / (young * iy);
  bend_z.psi.z = o.tensile_strength * (h * w * w / 6) * length / (young * iz);
  shear_y.gamma_y = o.shear_strength * area / one_point;
  shear_z.gamma_z = o.shear_strength * area / one_point;
  torsion.psi.x = o.shear_strength / torsion_stress(twist);
  const double open = o.energy * area, slide = o.energy_shear * area;
  return {{"tension", tension, open},        {"bending about 2", bend_y, open},
          {"bending about 3", bend_z, open}, {"shear in 2", shear_y, slide},
          {"shear in 3", shear_z, slide},    {"torsion", torsion, slide}};
}

TEST(Fracture, BeginsAtTheStrengthInEachMode) {
  for (const Mode& mode : modes()) {
    test::OneBeam beam(test::one_beam(length, w, h), options());
    beam.go(0.999999 * mode.at_strength);
    EXPECT_EQ(beam.reported("beams_damaged"), 0) << mode.name;
    EXPECT_NEAR(beam.fracture->overload(beam.state()), 0.999999, 1e-9) << mode.name;
    beam.go(1.000001 * mode.at_strength);
    EXPECT_EQ(beam.reported("beams_damaged"), 1) << mode.name;
  }
}

/// Strained at growing steps until nothing is left: the fracture energy of the mode, and a ledger
/// that closes as leapfrog's does.
TEST(Fracture, DissipatesTheFractureEnergy) {
  for (const Mode& mode : modes()) {
    for (const bool dynamic : {true, false}) {
      for (const double step : {0.2, 0.05, 0.01}) {
        test::OneBeam beam(test::one_beam(length, w, h), options(dynamic));
        double s = 0;
        while (beam.reported("beams_broken") == 0 && s < 1000) {
          s += step;
          dynamic ? beam.go(s * mode.at_strength) : beam.settle(s * mode.at_strength);
        }
        const double dissipated = beam.reported("energy_fracture");
        test::verify({.section = "Fracture",
                      .quantity = std::string("energy dissipated by one beam in ") + mode.name +
                                  ", step " + std::to_string(step).substr(0, 4) +
                                  " of the strength's strain" + (dynamic ? "" : ", statics"),
                      .value = dissipated / mode.nominal,
                      .reference = 1,
                      .tolerance = step < 0.02 ? 1e-3 : 1e-2,
                      .unit = "G A"});
        EXPECT_EQ(beam.reported("energy_strain"), 0);
        EXPECT_EQ(beam.reported("beams_brittle"), 0);
        if (dynamic) {
          EXPECT_NEAR(beam.work, dissipated, 1e-9 * mode.nominal);
        }
        const auto breaks = beam.fracture->breaks();
        ASSERT_EQ(breaks.size(), 1);
        EXPECT_NEAR(breaks[0].energy, dissipated, 1e-12 * mode.nominal);
        EXPECT_NEAR(breaks[0].nominal, mode.nominal, 1e-9 * mode.nominal);
      }
    }
  }
}

TEST(Fracture, MixedModesWeighTheEnergies) {
  const auto all = modes();
  const test::Strain& open = all[0].at_strength;
  const test::Strain& slide = all[3].at_strength;
  for (const double part : {0.2, 0.5, 0.8}) {
    // s^2 = a^2 + b^2
    const double a = std::cos(part * std::numbers::pi / 2),
                 b = std::sin(part * std::numbers::pi / 2);
    test::Strain both = a * open;
    both.gamma_y = b * slide.gamma_y;
    test::OneBeam beam(test::one_beam(length, w, h), options());
    double s = 0;
    for (; beam.reported("beams_broken") == 0 && s < 1000; s += 0.01) beam.go(s * both);
    const double u_open = 0.5 * young * area / length * both.delta * both.delta;
    const double u_slide = 0.5 * 5.0 / 6 * shear * area / length * both.gamma_y * both.gamma_y;
    const double beta = u_slide / (u_open + u_slide);
    const double expected = area / ((1 - beta) / 15 + beta / 25);
    EXPECT_NEAR(beam.fracture->breaks().at(0).mode_mix, beta, 1e-9);
    EXPECT_NEAR(beam.reported("energy_fracture"), expected, 1e-3 * expected);
    EXPECT_NEAR(beam.work, beam.reported("energy_fracture"), 1e-9 * expected);
  }
}

TEST(Fracture, IsIrreversibleAndWholeInCompression) {
  const Mode tension = modes()[0];
  const double k = young * area / length;
  test::OneBeam beam(test::one_beam(length, w, h), options());
  for (double s = 0; s < 1.5; s += 0.01) beam.go(s * tension.at_strength);
  beam.go(1.5 * tension.at_strength);
  const double damage = beam.fracture->damage(0), lost = beam.reported("energy_fracture");
  EXPECT_GT(damage, 0.3);
  EXPECT_LT(damage, 0.9);
  // Unloads and reloads along the secant.
  for (const double s : {1.0, 0.3, 0.0, 0.7, 1.49}) {
    beam.go(s * tension.at_strength);
    EXPECT_NEAR(beam.on_end()[0], -(1 - damage) * k * s * tension.at_strength.delta,
                1e-9 * k * tension.at_strength.delta);
    EXPECT_EQ(beam.reported("energy_fracture"), lost);
    EXPECT_EQ(beam.fracture->damage(0), damage);
  }
  // Whole in compression, far beyond the strength; bending and shear are damaged there too.
  test::Strain pressed = -5 * tension.at_strength;
  beam.go(pressed);
  EXPECT_NEAR(beam.on_end()[0], -k * pressed.delta, 1e-9 * k * std::abs(pressed.delta));
  EXPECT_EQ(beam.fracture->damage(0), damage);
  pressed.psi.y = 1e-6;
  beam.go(pressed);
  EXPECT_NEAR(beam.on_end()[4], -(1 - damage) * young * iy / length * 1e-6,
              1e-6 * young * iy / length * 1e-6);
  EXPECT_EQ(beam.fracture->damage(0), damage);
  EXPECT_EQ(beam.reported("energy_fracture"), lost);
}

TEST(Fracture, NeverBreaksUnderPressureAlone) {
  test::OneBeam beam(test::one_beam(length, w, h), options());
  for (double s = 0; s < 50; s += 1) beam.go(-s * modes()[0].at_strength);
  EXPECT_EQ(beam.reported("beams_damaged"), 0);
}

/// Bent until it breaks while it is pressed: what the pressure stored is dissipated as well.
TEST(Fracture, WhatIsStoredInCompressionGoesWhenTheBeamBreaks) {
  test::Strain strain = -0.5 * modes()[0].at_strength;
  test::OneBeam beam(test::one_beam(length, w, h), options());
  beam.go(strain);
  const double pressed = beam.reported("energy_strain");
  for (double s = 0; beam.reported("beams_broken") == 0 && s < 100; s += 0.01) {
    strain.psi.y = s * modes()[1].at_strength.psi.y;
    beam.go(strain);
  }
  EXPECT_EQ(beam.reported("energy_strain"), 0);
  // s = M/M_t - 1/2, so U_d = U_1 ((s + 1/2)/1.5)^2: the integral of U_d dD from s = 1 to s_u.
  const double nominal = 15 * area;
  const double psi = 1.5 * modes()[1].at_strength.psi.y;
  const double first = 0.5 * young * iy / length * psi * psi, ultimate = nominal / first;
  const double bent = ultimate / (ultimate - 1) * first / 2.25 *
                      (ultimate - 1 + std::log(ultimate) + 0.25 * (1 - 1 / ultimate));
  EXPECT_NEAR(beam.reported("energy_fracture"), bent + pressed, 1e-3 * nominal);
  EXPECT_GT(pressed, 0.03 * nominal);
  EXPECT_NEAR(beam.work, beam.reported("energy_fracture"), 1e-9 * nominal);
  EXPECT_EQ(beam.on_end()[0], 0);
}

/// Long beams have no softening branch: they break at once with what they stored.
TEST(Fracture, LongBeamsAreBrittle) {
  const double limit = 2 * young * 15 / (6e5 * 6e5);
  for (const double l : {0.99 * limit, 1.01 * limit}) {
    test::OneBeam beam(test::one_beam(l, w, h), options());
    test::Strain strength;
    strength.delta = 6e5 * l / young;
    beam.go(0.9995 * strength);
    beam.go(1.0005 * strength);
    const bool brittle = l > limit;
    EXPECT_EQ(beam.reported("beams_brittle"), brittle ? 1 : 0);
    EXPECT_EQ(beam.reported("beams_broken"), brittle ? 1 : 0);
    if (!brittle) continue;
    const double stored = 0.5 * young * area / l * strength.delta * strength.delta;
    EXPECT_NEAR(beam.reported("energy_fracture"), stored, 2e-3 * stored);
    EXPECT_GT(beam.reported("energy_fracture"), 15 * area);
    EXPECT_TRUE(beam.fracture->breaks().at(0).brittle);
  }
}

/// A state that was tried and not committed leaves no trace.
TEST(Fracture, EvaluationIsNoHistory) {
  const Mode mode = modes()[0];
  test::OneBeam beam(test::one_beam(length, w, h), options());
  beam.go(0.5 * mode.at_strength);
  const double force = beam.on_end()[0];
  State<Spatial> beyond = beam.state();
  beyond.record(1)[0] = 2 * mode.at_strength.delta;
  Wrenches<Spatial> other(2);
  beam.force->add(beyond, other);
  EXPECT_GT(std::abs(other.of(1)[0]), 0);
  beam.evaluate();
  EXPECT_EQ(beam.on_end()[0], force);
  EXPECT_EQ(beam.fracture->damage(0), 0);
  EXPECT_EQ(beam.reported("energy_fracture"), 0);
}

/// Of damaged beams at large rotations, in tension and in compression.
TEST(Fracture, DamagedForcesHaveAPotentialAndATangent) {
  for (const double along : {2e-5, -2e-5}) {
    test::OneBeam beam(test::one_beam(length, w, h), options(false), 0, Kinematics::corotational);
    for (double s = 0; s < 1.4; s += 0.1) beam.settle(s * modes()[1].at_strength);
    ASSERT_GT(beam.fracture->damage(0), 0.2);
    State<Spatial> state = beam.state();
    const Quat<double> turn = exp_rotation(Vec3<double>{0.4, -0.7, 0.3});
    const auto put = [&](std::size_t b, const Vec3<double>& u, const Quat<double>& q) {
      double* r = state.record(b);
      r[0] = u.x, r[1] = u.y, r[2] = u.z, r[3] = q.w, r[4] = q.x, r[5] = q.y, r[6] = q.z;
    };
    const Vec3<double> chord{length + along, 1e-5, -2e-5};
    const Vec3<double> moved = rotate(turn, chord) - Vec3<double>{length, 0, 0};
    put(0, {0, 0, 0}, turn);
    put(1, moved, product(turn, exp_rotation(Vec3<double>{1e-4, 2e-4, -1e-4})));
    test::expect_tangent_from_wrenches(*beam.force, beam.part(), state, 1e-7, 1e-5);
    // Energies and counts that do not change with the state drop out of the derivative.
    test::expect_wrenches_from_potential(*beam.force, state, 1e-7, 1e-5);
  }
}

/// Mean and scatter of strengths, and their size effect.
TEST(Fracture, StrengthsAreWeibulls) {
  for (const double m : {3.0, 8.0}) {
    constexpr int n = 200000;
    double sum = 0, sum2 = 0, large = 0;
    for (int k = 0; k < n; ++k) {
      const double f = weibull_factor(7, k, m, 1), g = weibull_factor(7, k, m, 4);
      sum += f, sum2 += f * f, large += g;
    }
    const double mean = sum / n, gamma1 = std::tgamma(1 + 1 / m), gamma2 = std::tgamma(1 + 2 / m);
    const double deviation = std::sqrt(gamma2 / (gamma1 * gamma1) - 1);
    const double error = 4 * deviation / std::sqrt(n);
    EXPECT_NEAR(mean, 1, error);
    EXPECT_NEAR(std::sqrt(sum2 / n - mean * mean), deviation, 0.01 * deviation);
    EXPECT_NEAR(large / n, std::pow(0.25, 1 / m), error);
    // Distribution, seeds and neighbours: a fraction 1 - exp(-(x Gamma)^m) lies below x.
    int below = 0, both = 0, other = 0;
    for (int k = 0; k < n; ++k) {
      const bool one = weibull_factor(7, k, m, 1) < 0.8;
      below += one;
      both += one && weibull_factor(7, k + 1, m, 1) < 0.8;
      other += one && weibull_factor(8, k, m, 1) < 0.8;
    }
    const double p = 1 - std::exp(-std::pow(0.8 * gamma1, m));
    EXPECT_NEAR(below / double(n), p, 4 * std::sqrt(p / n));
    EXPECT_NEAR(both / double(n), p * p, 4 * std::sqrt(p * p / n));
    EXPECT_NEAR(other / double(n), p * p, 4 * std::sqrt(p * p / n));
  }
}

/// Statics take breaks back when no equilibrium is left; the beam then has its stiffness once.
TEST(Fracture, ARetreatLeavesTheBoundOfTheStiffness) {
  test::OneBeam beam(test::one_beam(length, w, h), options(false));
  const double before = stiffness_bound(*beam.force, 0);
  ASSERT_GT(before, 0);
  test::OneBeam stretched(test::one_beam(length, w, h), options());
  stretched.go(20.0 * modes()[0].at_strength);
  for (int round = 0; round < 3; ++round) {
    ASSERT_EQ(beam.fracture->advance(stretched.state()), Advance::broke);
    beam.fracture->retreat();
    EXPECT_EQ(beam.fracture->damage(0), 0);
    EXPECT_EQ(stiffness_bound(*beam.force, 0), before);
  }
}

TEST(Fracture, NeedsTheSectionsSides) {
  Lattice lattice = test::one_beam(length, w, h);
  lattice.beams.width.clear(), lattice.beams.height.clear();
  const Part part = partition(lattice, PETSC_COMM_SELF);
  EXPECT_THROW((void)make_breakable_beams(part, {}, options()), InputError);
}

}  // namespace
}  // namespace floe
