// Moduli of the infinite regular lattice (model.md, "Effective moduli of the lattice, calibrated
// sheets"), measured in a patch of that lattice whose outermost bodies are given the motion of a
// uniform strain or curvature. All others are free. That motion is then the exact answer
// everywhere, so the beams round an inner body carry the forces of the infinite lattice: mean
// stresses and moments are sums of the beams' section forces over that body's hexagon. The patch is
// solved by the same solver as any scene.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "support/homogenise.h"
#include "support/record.h"
#include "support/triangles.h"

namespace floe::test {
namespace {

constexpr const char* section_name = "Regular triangular lattice";

/// Largest difference of any free body's motion from `motion`, over the largest of `motion`;
/// rotations times `length`.
double largest_departure(const Lattice& lattice, const State<Spatial>& state, const Motion& motion,
                         double length) {
  double departure = 0, size = 0;
  for (std::size_t b = 0; b < lattice.bodies.position.size(); ++b) {
    const Point3& x = lattice.bodies.position[b];
    const std::array<double, 6> m = motion(x[0], x[1]);
    const Vec3<double> u = displacement(state, b);
    const Quat<double> q = rotation(state, b);
    const std::array<double, 6> got{u.x, u.y, u.z, 2 * q.x, 2 * q.y, 2 * q.z};
    for (std::size_t k = 0; k < 6; ++k) {
      departure = std::max(departure, std::abs(got[k] - m[k]) * (k < 3 ? 1 : length));
      size = std::max(size, std::abs(m[k]) * (k < 3 ? 1 : length));
    }
  }
  return departure / size;
}

const Ice ice;
constexpr double kappa = 5.0 / 6, spacing = 1.5;
constexpr int rings = 6;
constexpr double turn = 0.3;  // so that no beam lies along an axis

TEST(RegularLattice, InPlaneModuli) {
  const double h = 0.5;
  const Triangles t = triangles(rings, spacing, h, ice, kappa, Torsion::saint_venant, turn);
  for (const Kinematics kinematics : {Kinematics::corotational, Kinematics::linear}) {
    // Moduli are derivatives at zero strain: co-rotational ones differ by the strain.
    const double strain = kinematics == Kinematics::linear ? 1e-3 : 1e-8;
    for (const Shear shear : all_shears) {
      Response response{};
      double departure = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        Tensor e{};
        e[k] = strain;
        const Motion motion = stretching(e);
        Scene scene;
        scene.forces.beam = true;
        scene.beam = {shear, kinematics};
        scene.boundaries = rim_moves(t.lattice, motion, all_fixed);
        const StaticSolution s = solve_static(scene, t.lattice);
        ASSERT_TRUE(s.result.done);
        departure = std::max(departure, largest_departure(t.lattice, s.last(), motion, spacing));
        const Tensor sum = resultants(t.lattice, s, one_body(t.lattice, t.centre, t.cell)).membrane;
        for (std::size_t c = 0; c < 3; ++c) response[k][c] = sum[c] / (h * strain * ice.young);
      }
      // Plane stress: C_xx,xx = E/(1 - nu^2), C_xx,yy = nu E/(1 - nu^2), C_xy,xy = 2 G.
      const Isotropic c = isotropic(response);
      const LatticeModuli exact =
          lattice_moduli(spacing, h, ice, kappa, shear, Torsion::saint_venant);
      const auto check_one = [&](const char* what, double value, double reference,
                                 double tolerance) {
        verify({.section = section_name,
                .quantity = std::string(what) + ", " + name_of(shear) + ", " + name_of(kinematics),
                .value = value,
                .reference = reference,
                .tolerance = tolerance,
                .note = "inner body of a patch under uniform strain"});
      };
      check_one("E*/Eb", c.young(), exact.young, 1e-6);
      check_one("nu*", c.poisson(), exact.poisson, 1e-6);
      check_one("G*/Eb", response[2][2] / 2, exact.shear, 1e-6);
      check_one("K*/Eb", c.bulk, exact.bulk, 1e-6);
      EXPECT_LE(c.departure, 1e-6)
          << "not isotropic: " << name_of(shear) << " " << name_of(kinematics);
      EXPECT_LE(departure, 1e-6) << "strain not uniform: " << name_of(shear) << " "
                                 << name_of(kinematics);
    }
  }
}

TEST(RegularLattice, PlateBending) {
  struct Case {
    double times;
    Torsion torsion;
  };
  for (const auto& [times, torsion] : {Case{2, Torsion::saint_venant}, Case{2, Torsion::polar},
                                       Case{3, Torsion::saint_venant}, Case{3, Torsion::polar}}) {
    const double h = spacing / times;
    const Triangles t = triangles(rings, spacing, h, ice, kappa, torsion, turn);
    const double curvature = 1e-6;
    for (const Shear shear : all_shears) {
      Response response{};
      double departure = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        Tensor c{};
        c[k] = curvature;
        const Motion motion = bending(c);
        Scene scene;
        scene.forces.beam = true;
        scene.beam.shear = shear;
        scene.boundaries = rim_moves(t.lattice, motion, all_fixed);
        const StaticSolution s = solve_static(scene, t.lattice);
        ASSERT_TRUE(s.result.done);
        departure = std::max(departure, largest_departure(t.lattice, s.last(), motion, spacing));
        const Tensor sum = resultants(t.lattice, s, one_body(t.lattice, t.centre, t.cell)).moment;
        const double plate = ice.young * h * h * h / (12 * (1 - ice.poisson * ice.poisson));
        for (std::size_t m = 0; m < 3; ++m) response[k][m] = sum[m] / (curvature * plate);
      }
      const Isotropic d = isotropic(response);
      const LatticeModuli exact = lattice_moduli(spacing, h, ice, kappa, shear, torsion);
      const auto check_one = [&](const char* what, double value, double reference) {
        char name[80];
        std::snprintf(name, sizeof name, "%s, l=%gh, %s, %s", what, times,
                      torsion == Torsion::polar ? "polar" : "saint_venant", name_of(shear).c_str());
        verify({.section = section_name,
                .quantity = name,
                .value = value,
                .reference = reference,
                .tolerance = 1e-6,
                .note = "inner body of a patch under uniform curvature"});
      };
      check_one("D*/D", d.direct(), exact.bending);
      check_one("nu_b*", d.poisson(), exact.bending_poisson);
      EXPECT_LE(d.departure, 1e-6) << "not isotropic: " << times << " " << name_of(shear);
      EXPECT_LE(departure, 1e-6) << "curvature not uniform: " << times << " " << name_of(shear);
    }
  }
}

/// A slope without rotation of the bodies: all transverse, Q = kappa G h times the slope.
TEST(RegularLattice, TransverseShearStiffness) {
  const double h = 0.5, slope = 1e-6;
  const Triangles t = triangles(rings, spacing, h, ice, kappa, Torsion::saint_venant, turn);
  for (const bool along_x : {true, false}) {
    const Motion motion = [&](double x, double y) {
      return std::array<double, 6>{0, 0, slope * (along_x ? x : y), 0, 0, 0};
    };
    Scene scene;
    scene.forces.beam = true;
    scene.boundaries = rim_moves(t.lattice, motion, {true, true, true, false, false, false});
    Boundary upright;
    upright.name = "upright", upright.set = "all";
    upright.fixed = {false, false, false, true, true, true};
    scene.boundaries.push_back(upright);
    const StaticSolution s = solve_static(scene, t.lattice);
    ASSERT_TRUE(s.result.done);
    EXPECT_LE(largest_departure(t.lattice, s.last(), motion, spacing), 1e-6);
    const Resultants r = resultants(t.lattice, s, one_body(t.lattice, t.centre, t.cell));
    const double stiffness = kappa * ice.young / (2 * (1 + ice.poisson)) * h;
    verify({.section = section_name,
            .quantity = text("transverse shear stiffness along %s, one_point", along_x ? "x" : "y"),
            .value = r.transverse[along_x ? 0 : 1] / (slope * stiffness),
            .reference = 1.0,
            .tolerance = 1e-6,
            .unit = "kappa G h"});
    EXPECT_LE(std::abs(r.transverse[along_x ? 1 : 0]) / (slope * stiffness), 1e-6);
  }
}

/// Compares the closed forms that floe reports with the table of model.md, "Effective moduli of the
/// lattice, calibrated sheets".
TEST(RegularLattice, ClosedFormsAgainstPublishedTable) {
  struct InPlane {
    Shear shear;
    double young, poisson;
  };
  for (const auto& [shear, young, poisson] :
       {InPlane{Shear::none, .8, .2}, InPlane{Shear::exact, .7355, .2645},
        InPlane{Shear::one_point, .7954, .2046}}) {
    const LatticeModuli m = lattice_moduli(2, 1, ice, kappa, shear, Torsion::saint_venant);
    EXPECT_NEAR(m.young, young, 5e-5) << name_of(shear);
    EXPECT_NEAR(m.poisson, poisson, 5e-5) << name_of(shear);
    EXPECT_NEAR(m.shear, m.young / (2 * (1 + m.poisson)), 1e-15) << name_of(shear);
    EXPECT_NEAR(m.bulk, m.young / (2 * (1 - m.poisson)), 1e-15) << name_of(shear);
  }
  struct Plate {
    double l;
    Torsion torsion;
    double g, bending;
  };
  for (const auto& [l, torsion, g, bending] :
       {Plate{2, Torsion::saint_venant, .742, .851}, Plate{2, Torsion::polar, .897, .887},
        Plate{3, Torsion::saint_venant, .984, .906}, Plate{3, Torsion::polar, 1.539, 1.033}}) {
    const LatticeModuli m = lattice_moduli(l, 1, ice, kappa, Shear::one_point, torsion);
    EXPECT_NEAR(m.bending, bending, 5.1e-4) << l;
    EXPECT_NEAR(m.bending_poisson, (1 - g) / (3 + g), 2e-4) << l;
  }
}

}  // namespace
}  // namespace floe::test
