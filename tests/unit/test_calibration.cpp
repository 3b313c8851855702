// What calibration does to a sheet's beams; what it leads to is verified in
// verification/test_calibration.cpp.
#include <gtest/gtest.h>

#include <cmath>

#include "beams/beam_force.h"
#include "floe/beams/calibration.h"
#include "support/lattices.h"

namespace floe::test {
namespace {

Ice ice_of(double poisson) {
  Ice ice;
  ice.poisson = poisson;
  return ice;
}

/// A meshed sheet of this ice.
Lattice sheet_of(const Ice& ice) {
  Lattice s = sheet(20, 15, 1);
  for (double& shear_modulus : s.beams.shear_modulus)
    shear_modulus = ice.young / (2 * (1 + ice.poisson));
  return s;
}

TEST(Calibrate, LeavesBodiesAndGeometryAlone) {
  for (const Calibrate kind : {Calibrate::young, Calibrate::isotropic}) {
    const Ice ice = ice_of(0.3);
    const Lattice before = sheet_of(ice);
    Lattice after = before;
    (void)calibrate(after, ice, kind, Shear::one_point);
    EXPECT_EQ(after.bodies.mass, before.bodies.mass);
    EXPECT_EQ(after.beams.area, before.beams.area);
    EXPECT_EQ(after.beams.inertia_y, before.beams.inertia_y);
    EXPECT_EQ(after.beams.inertia_z, before.beams.inertia_z);
    EXPECT_EQ(after.beams.width, before.beams.width);
    EXPECT_EQ(after.beams.shear_factor, before.beams.shear_factor);
    EXPECT_NE(after.beams.young, before.beams.young);
  }
}

TEST(Calibrate, YoungScalesEveryStiffnessByOneNumber) {
  const Ice ice = ice_of(0.3);
  for (const Shear shear : {Shear::one_point, Shear::exact, Shear::none}) {
    const Lattice before = sheet_of(ice);
    Lattice after = before;
    const Calibration c = calibrate(after, ice, Calibrate::young, shear);
    EXPECT_NEAR(c.moduli.young, 1, 1e-14);
    EXPECT_NEAR(c.scale, 1.3, 0.1);
    for (std::int32_t m = 0; m < before.beams.size(); ++m) {
      const BeamStiffness a = beam_stiffness(before.beams, m, shear),
                          b = beam_stiffness(after.beams, m, shear);
      for (const auto of : {&BeamStiffness::kn, &BeamStiffness::ksz, &BeamStiffness::ksy,
                            &BeamStiffness::kt, &BeamStiffness::kby, &BeamStiffness::kbz})
        EXPECT_NEAR(b.*of / (a.*of), c.scale, 1e-13);
    }
  }
}

TEST(Calibrate, IsotropicSetsFourStiffnesses) {
  for (const double nu : {-0.2, 0.1, 0.3, 1.0 / 3}) {
    const Ice ice = ice_of(nu);
    const Lattice before = sheet_of(ice);
    Lattice after = before;
    const Calibration c = calibrate(after, ice, Calibrate::isotropic, Shear::one_point);
    EXPECT_NEAR(c.scale, 1 / (1 - nu), 1e-14);
    EXPECT_NEAR(c.moduli.young, 1, 1e-8);
    EXPECT_NEAR(c.moduli.poisson, nu, 1e-8);
    EXPECT_NEAR(c.moduli.bending, 1, 1e-8);
    EXPECT_NEAR(c.moduli.bending_poisson, nu, 1e-8);
    // Irregular cells give way, so their k_s and k_t are more than the regular lattice's.
    EXPECT_GT(c.ratios.shear, (1 - 3 * nu) / (1 + nu));
    EXPECT_GT(c.ratios.torsion, (1 - 3 * nu) / (1 + nu));

    std::vector<int> sides(before.bodies.position.size(), 0);
    int bit = 1;
    for (const char* side : {"left", "right", "bottom", "top"}) {
      for (const std::int32_t body : before.sets.at(side))
        sides[static_cast<std::size_t>(body)] |= bit;
      bit *= 2;
    }
    int at_edge = 0;
    double shear = 0, torsion = 0;
    for (std::int32_t m = 0; m < before.beams.size(); ++m) {
      const auto [i, j] = before.beams.bodies[static_cast<std::size_t>(m)];
      const bool edge =
          (sides[static_cast<std::size_t>(i)] & sides[static_cast<std::size_t>(j)]) != 0;
      at_edge += edge;
      const double scale = c.scale * (edge ? 1 - 0.6 * nu : 1);
      const BeamStiffness a = beam_stiffness(before.beams, m, Shear::one_point),
                          b = beam_stiffness(after.beams, m, Shear::one_point);
      EXPECT_NEAR(b.kn / a.kn, scale, 1e-13);
      EXPECT_NEAR(b.kby / a.kby, scale, 1e-13);
      EXPECT_EQ(b.ksy, a.ksy);
      EXPECT_GT(b.ksz, 0);
      EXPECT_GT(b.kt, 0);
      shear += b.ksz / b.kn / before.beams.size();
      torsion += b.kt / b.kby / before.beams.size();
    }
    EXPECT_NEAR(at_edge, 70, 12);  // one per metre of the edge
    EXPECT_NEAR(shear, c.ratios.shear, 0.01);
    EXPECT_NEAR(torsion, c.ratios.torsion, 0.01);
  }
}

TEST(Calibrate, UnevenDirectionsOfBeamsAreMadeUpFor) {
  const Ice ice = ice_of(0.3);
  Lattice s = sheet_of(ice);
  const Calibration c = calibrate(s, ice, Calibrate::isotropic, Shear::one_point);
  ASSERT_GT(std::abs(c.ratios.texture), 0.005);
  // The part of the affine stiffness that turns four times, over the whole, inside.
  std::vector<int> inner(s.bodies.position.size(), 1);
  for (const char* side : {"left", "right", "bottom", "top"})
    for (const std::int32_t body : s.sets.at(side)) inner[static_cast<std::size_t>(body)] = 0;
  std::complex<double> stretching = 0, bending = 0;
  double all = 0;
  for (std::int32_t m = 0; m < s.beams.size(); ++m) {
    const auto k = static_cast<std::size_t>(m);
    const auto i = static_cast<std::size_t>(s.beams.bodies[k][0]),
               j = static_cast<std::size_t>(s.beams.bodies[k][1]);
    const double phi = std::atan2(s.bodies.position[j][1] - s.bodies.position[i][1],
                                  s.bodies.position[j][0] - s.bodies.position[i][0]);
    const BeamStiffness b = beam_stiffness(s.beams, m, Shear::one_point);
    const double plan = (inner[i] + inner[j]) * s.beams.width[k] * s.beams.length[k];
    all += plan;
    stretching += plan * (1 - b.ksz / b.kn) * std::polar(1.0, 4 * phi);
    bending += plan * (1 - b.kt / b.kby) * std::polar(1.0, 4 * phi);
  }
  EXPECT_LT(std::abs(stretching) / all, 0.2 * std::abs(c.ratios.texture));
  EXPECT_LT(std::abs(bending) / all, 0.2 * std::abs(c.ratios.texture));
}

TEST(LatticeRatios, RegularAndRandomCells) {
  Lattice s = sheet_of(ice_of(0.3));
  const LatticeRatios ratios = lattice_ratios(s, Shear::one_point);
  EXPECT_NEAR(ratios.shear, 5.0 / 6 / 2.6, 1e-12);
  EXPECT_NEAR(ratios.transverse, 5.0 / 6 / 2.6 * 12 / (0.5 * 0.5) / 4, 0.6);  // l is 1 m on average
  EXPECT_GT(ratios.irregularity, 0.1);                                        // 20 iterations
  EXPECT_LT(ratios.irregularity, 0.25);
  // Lengths and moduli have units, ratios have none.
  for (Point3& x : s.bodies.position) x = 1000 * x;
  for (double& l : s.beams.length) l *= 1000;
  for (double& a : s.beams.area) a *= 1e6;
  for (auto* second : {&s.beams.inertia_y, &s.beams.inertia_z, &s.beams.torsion})
    for (double& moment : *second) moment *= 1e12;
  const LatticeRatios scaled = lattice_ratios(s, Shear::one_point);
  EXPECT_NEAR(scaled.irregularity / ratios.irregularity, 1, 1e-12);
  EXPECT_NEAR(scaled.transverse / ratios.transverse, 1, 1e-12);
  EXPECT_NEAR(std::abs(scaled.texture - ratios.texture), 0, 1e-12);
}

}  // namespace
}  // namespace floe::test
