// The law of fracture for one beam under pressure (Mohr and Coulomb), and with a weight of bending.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "fracture_laws/strengths.h"
#include "support/one_beam.h"
#include "support/record.h"

namespace floe {
namespace {

constexpr double length = 1, w = 0.3, h = 0.2, area = w * h, young = 4e9;
constexpr double tension = 6e5, shear = 5e5, compression = 3e6, g = 15, g_shear = 25;

FractureOptions options(double compressive_strength, bool dynamic = true) {
  FractureOptions o;
  o.propagation = Propagation::strength;  // a single beam has no cracks
  o.tensile_strength = tension, o.shear_strength = shear;
  o.compressive_strength = compressive_strength;
  o.energy = g, o.energy_shear = g_shear;
  o.dynamic = dynamic;
  return o;
}

/// Strains of a beam of length l under given nominal stresses: mean stress along the axis, shear
/// along axes 2 and 3, bending about axis 2 and 3, torsion (all at the extreme fibre) [Pa].
struct Stresses {
  double axial = 0, shear_y = 0, shear_z = 0, bending_y = 0, bending_z = 0, torsion = 0;
};
test::Strain strain_of(const Stresses& s, double l = length) {
  const double modulus = young / 2.6, one_point = 5.0 / 6 * modulus / l;  // per area
  const double a = std::max(w, h), b = std::min(w, h);
  test::Strain strain;
  strain.delta = s.axial * l / young;
  strain.gamma_y = s.shear_y / one_point, strain.gamma_z = s.shear_z / one_point;
  strain.psi.y = s.bending_y * l / (young * h / 2);
  strain.psi.z = s.bending_z * l / (young * w / 2);
  strain.psi.x =
      s.torsion * a * b * b / (3 + 1.8 * b / a) * l / (modulus * saint_venant_torsion(w, h));
  return strain;
}

double criterion_at(const FractureOptions& o, const Stresses& s) {
  test::OneBeam beam(test::one_beam(length, w, h), o);
  beam.go(strain_of(s));
  // A beam that has broken is not overloaded: the criterion of one that stays whole.
  if (beam.reported("beams_damaged") > 0) return INFINITY;
  return beam.fracture->overload(beam.state());
}

/// Shear stress at which a beam pressed by p fails: the least at which Coulomb's law holds on some
/// plane, by looking at all of them.
double coulomb_shear(double p) {
  const double phi = std::asin(1 - 2 * shear / compression), c = shear / std::cos(phi);
  const auto worst = [&](double tau) {
    double most = -INFINITY;
    constexpr int planes = 20000;
    for (int k = 0; k < planes; ++k) {
      const double theta = k * std::numbers::pi / planes;
      const double sin = std::sin(theta), cos = std::cos(theta);
      const double normal = -p * cos * cos + 2 * tau * sin * cos;
      const double along = p * sin * cos + tau * (cos * cos - sin * sin);
      most = std::max(most, std::abs(along) + std::tan(phi) * normal);
    }
    return most - c;
  };
  double low = 0, high = 1e8;
  while (high - low > 1) {
    const double middle = (low + high) / 2;
    (worst(middle) < 0 ? low : high) = middle;
  }
  return low;
}

/// Shear along axis 2 at which the beam breaks [Pa].
double breaking_shear(const FractureOptions& o, double axial) {
  double low = 0, high = 1e7;
  while (high - low > 0.01) {
    const double middle = (low + high) / 2;
    Stresses s;
    s.axial = axial, s.shear_y = middle;
    (criterion_at(o, s) < 1 ? low : high) = middle;
  }
  return low;
}

TEST(FractureUnderPressure, PressureRaisesTheShearThatABeamStandsAsCoulombSays) {
  for (const double p : {0.0, 2e5, 1e6, 2e6, 2.8e6})
    test::verify({.section = "Fracture",
                  .quantity = test::text("shear strength of a beam under %.1f MPa", p / 1e6),
                  .value = breaking_shear(options(compression), -p),
                  .reference = coulomb_shear(p),
                  .tolerance = 1e-5 * shear,
                  .unit = "Pa"});
  // Without a compressive strength pressure does nothing.
  EXPECT_NEAR(breaking_shear(options(0), -1e6), shear, 1);
  // In tension both are the same, and the two laws meet at no axial stress.
  for (const double pull : {1e5, 4e5})
    EXPECT_EQ(breaking_shear(options(compression), pull), breaking_shear(options(0), pull));
  Stresses s;
  s.shear_y = 3e5, s.shear_z = 2e5;
  const double between = criterion_at(options(compression), s);
  for (const double axial : {-1.0, 1.0}) {
    s.axial = axial;
    EXPECT_NEAR(criterion_at(options(compression), s), between, 1e-5);
  }
}

TEST(FractureUnderPressure, ABeamCrushesAtTheCompressiveStrength) {
  for (const bool dynamic : {true, false}) {
    test::OneBeam beam(test::one_beam(length, w, h), options(compression, dynamic));
    const auto to = [&](double part) {
      Stresses s;
      s.axial = -part * compression;
      dynamic ? beam.go(strain_of(s)) : beam.settle(strain_of(s));
    };
    to(0.99999);
    EXPECT_EQ(beam.reported("beams_damaged"), 0);
    EXPECT_NEAR(beam.fracture->overload(beam.state()), 0.99999, 1e-9);
    const double stored = beam.reported("energy_strain");
    EXPECT_NEAR(stored, compression * compression * length / (2 * young) * area, 1e-4 * stored);
    to(1.00001);
    EXPECT_EQ(beam.reported("beams_broken"), 1);
    EXPECT_EQ(beam.reported("beams_crushed"), 1);
    EXPECT_EQ(beam.reported("energy_strain"), 0);
    EXPECT_EQ(beam.on_end()[0], 0);  // gone: its bodies touch from now on
    EXPECT_NEAR(beam.reported("energy_fracture"), stored, 1e-4 * stored);
    EXPECT_NEAR(beam.fracture->breaks().at(0).mode_mix, 1, 1e-12);
    ASSERT_EQ(beam.fracture->released().size(), 1);
    if (dynamic) {
      EXPECT_NEAR(beam.work, beam.reported("energy_fracture"), 1e-9 * stored);
    }
  }
}

/// The more compressed fibre of a bent and pressed beam crushes, or the other one opens.
TEST(FractureUnderPressure, TheExtremeFibresDecide) {
  for (const double p : {1e6, 2e6, 2.5e6}) {
    for (const bool about_y : {true, false}) {
      const double bent = std::min(p + tension, compression - p);
      for (const double sign : {-1.0, 1.0}) {
        Stresses s;
        s.axial = -p;
        (about_y ? s.bending_y : s.bending_z) = sign * 0.9999 * bent;
        EXPECT_LT(criterion_at(options(compression), s), 1) << p;
        (about_y ? s.bending_y : s.bending_z) = sign * 1.0001 * bent;
        EXPECT_GT(criterion_at(options(compression), s), 1) << p;
      }
    }
  }
}

/// A beam so short that it stores less than its fracture energy softens under pressure too and
/// dissipates G_s A, what it stores in compression being shear on inclined planes.
TEST(FractureUnderPressure, AShortBeamSoftensWithTheFractureEnergyOfShear) {
  constexpr double l = 0.005;
  for (const double slide : {0.0, 0.5, 2.0}) {  // shear over pressure
    test::OneBeam beam(test::one_beam(l, w, h), options(compression));
    const double before = 1e6 * slide * 1.0;
    for (double s = 0; beam.reported("beams_broken") == 0 && s < 100; s += 0.01) {
      Stresses stress;
      stress.axial = -1e6 * s, stress.shear_z = before * s;
      beam.go(strain_of(stress, l));
    }
    test::verify(
        {.section = "Fracture",
         .quantity = test::text("energy dissipated by a short beam under pressure and %.1f "
                                "times the shear",
                                slide),
         .value = beam.reported("energy_fracture") / (g_shear * area),
         .reference = 1,
         .tolerance = 1e-3,
         .unit = "G_s A"});
    EXPECT_EQ(beam.reported("beams_brittle"), 0);
    EXPECT_EQ(beam.reported("beams_crushed"), 1);
    EXPECT_EQ(beam.reported("energy_strain"), 0);
    EXPECT_NEAR(beam.work, beam.reported("energy_fracture"), 1e-9 * area);
  }
}

/// A beam that was damaged in tension is not stronger under pressure than a whole one.
TEST(FractureUnderPressure, ADamagedBeamCrushesAtTheSameStrength) {
  constexpr double l = 0.05;
  for (const bool dynamic : {true, false}) {
    test::OneBeam beam(test::one_beam(l, w, h), options(compression, dynamic));
    const auto to = [&](double axial) {
      Stresses s;
      s.axial = axial;
      dynamic ? beam.go(strain_of(s, l)) : beam.settle(strain_of(s, l));
    };
    for (double s = 0; s < 3; s += 0.01) to(s * tension);
    const double damage = beam.fracture->damage(0), lost = beam.reported("energy_fracture");
    ASSERT_GT(damage, 0.5);
    to(-0.9999 * compression);
    EXPECT_EQ(beam.fracture->damage(0), damage);
    EXPECT_EQ(beam.reported("energy_fracture"), lost);
    const double stored = beam.reported("energy_strain");
    to(-1.0001 * compression);
    EXPECT_EQ(beam.fracture->damage(0), 1);
    EXPECT_EQ(beam.reported("beams_crushed"), 1);
    EXPECT_NEAR(beam.reported("energy_fracture"), lost + stored, 1e-3 * stored);
    EXPECT_EQ(beam.reported("energy_strain"), 0);
  }
}

/// The weight acts on bending out of the plane, torsion and shear along axis 3, and on nothing
/// else.
TEST(FractureUnderPressure, TheWeightOfBendingLowersThreeStrengths) {
  FractureOptions o = options(0);
  o.bending_factor = 1.25;
  const auto at = [&](double Stresses::*what, double value) {
    Stresses s;
    s.*what = value;
    return criterion_at(o, s);
  };
  for (double Stresses::*same : {&Stresses::axial, &Stresses::bending_z})
    EXPECT_NEAR(at(same, 3e5), 3e5 / tension, 1e-9);
  EXPECT_NEAR(at(&Stresses::shear_y, 3e5), 3e5 / shear, 1e-9);
  EXPECT_NEAR(at(&Stresses::bending_y, 3e5), 1.25 * 3e5 / tension, 1e-9);
  EXPECT_NEAR(at(&Stresses::shear_z, 3e5), 1.25 * 3e5 / shear, 1e-9);
  EXPECT_NEAR(at(&Stresses::torsion, 3e5), 1.25 * 3e5 / shear, 1e-9);
}

/// A torsion constant beyond Saint-Venant's, as narrow facets of a calibrated sheet have, makes no
/// section weaker against its twist; one below it takes the moment as it is.
TEST(FractureUnderPressure, TorsionBeyondTheSectionsIsNotItsStress) {
  for (const double ratio : {0.5, 1.0, 20.0}) {
    Lattice lattice = test::one_beam(length, w, h);
    lattice.beams.torsion[0] *= ratio;
    test::OneBeam beam(lattice, options(0));
    Stresses s;
    s.torsion = 3e5;  // by the moment at Saint-Venant's constant
    beam.go(strain_of(s));
    EXPECT_NEAR(beam.fracture->overload(beam.state()), std::min(1.0, ratio) * 3e5 / shear, 1e-9);
  }
}

}  // namespace
}  // namespace floe
