// Floating sheets (model.md section 5): draft, stiffness against tilting, rigid sinking, and the
// deflection under a point load against an independent static solution and against Wyman's (1950)
// infinite plate.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "floe/forces/moduli.h"
#include "support/record.h"
#include "support/static_solution.h"

namespace floe::test {
namespace {

constexpr const char* section_name = "Bending of a floating sheet";
constexpr double load = 1e4;  // [N], downwards

/// A sheet on water, nothing prescribed, with a point load at the plan's centre that comes after
/// time 0.
Scene bending_scene(double length, double thickness, double element_size, std::uint64_t seed = 1) {
  Scene scene;
  scene.has_sheet = true;
  scene.sheet = {length, length, element_size, seed, Relaxation::lloyd, 150, 0};
  scene.thickness = thickness;
  scene.forces.beam = scene.forces.gravity = scene.forces.buoyancy = true;
  Load centre;
  centre.name = "centre";
  centre.point = Point2{0, 0};
  centre.force = {0, 0, -load};
  centre.ramp.seconds = 1;
  scene.loads = {centre};
  return scene;
}

/// Infinite plate of bending stiffness D on water under a point load P: characteristic length l_c =
/// (D/k)^(1/4), k = rho_w g, deflection w0 = P/(8 k l_c^2) under the load.
struct Wyman {
  double characteristic, centre;

  Wyman(const Scene& scene, double plate_stiffness) {
    const double k = scene.water_density * scene.gravity;
    characteristic = std::pow(plate_stiffness / k, 0.25);
    centre = load / (8 * k * characteristic * characteristic);
  }
  /// Of the material that the sheet's beams are made of.
  static Wyman of_material(const Scene& scene) {
    const double h = scene.thickness, nu = scene.ice.poisson;
    return {scene, scene.ice.young * h * h * h / (12 * (1 - nu * nu))};
  }
  /// Of the plate that the infinite regular lattice is.
  static Wyman of_lattice(const Scene& scene) {
    const LatticeModuli moduli =
        lattice_moduli(scene.sheet.element_size, scene.thickness, scene.ice, scene.shear_factor,
                       scene.beam.shear, scene.torsion);
    const double h = scene.thickness, nu = scene.ice.poisson;
    return {scene, moduli.bending * scene.ice.young * h * h * h / (12 * (1 - nu * nu))};
  }
  double at(double r) const;  ///< deflection at distance r from the load [m]
};

/// w/w0 = -(4/pi) kei(x), x = r/l_c. kei x = Im K0(x exp(i pi/4)), K0(z) = int_0^inf exp(-z cosh t)
/// dt: the trapezoid rule converges faster than any power on this integrand (it and its derivatives
/// vanish at both ends).
double wyman_profile(double x) {
  constexpr double step = 1e-3;
  const double s = x / std::numbers::sqrt2;
  double kei = -0.5 * std::exp(-s) * std::sin(s);
  for (double t = step;; t += step) {
    const double c = s * std::cosh(t);
    if (c > 45) break;
    kei -= std::exp(-c) * std::sin(c);
  }
  return -4 / std::numbers::pi * kei * step;
}

double Wyman::at(double r) const { return centre * wyman_profile(r / characteristic); }

double deflection_under_load(const StaticSolution& s) {
  return displacement_of_load(s, s.first()).z - displacement_of_load(s, s.last()).z;
}

TEST(FloatingSheet, WymansProfileIsThePublishedFunction) {
  const std::array<std::array<double, 2>, 6> published{
      {{.5, .85508}, {1, .63025}, {1.5, .42195}, {2, .25770}, {3, .06509}, {5, -.01424}}};
  for (const auto& [x, w] : published) EXPECT_NEAR(wyman_profile(x), w, 6e-6) << x;
  const Scene scene = bending_scene(80, 1, 2);
  EXPECT_NEAR(Wyman::of_material(scene).characteristic, 13.8663, 5e-5);
  EXPECT_NEAR(Wyman::of_material(scene).centre, 0.65614e-3, 5e-9);
}

// -- the sheet as a rigid body --------------------------------------------------------------------

/// Puts the lattice elsewhere: turned by `turn` about y, then lifted.
void place_elsewhere(Lattice& lattice, double turn, double lift) {
  const Quat<double> q = exp_rotation({0, turn, 0});
  for (std::size_t b = 0; b < lattice.bodies.position.size(); ++b) {
    auto& [x, y, z] = lattice.bodies.position[b];
    const Vec3<double> moved = rotate(q, {x, y, z});
    lattice.bodies.position[b] = {moved.x, moved.y, moved.z + lift};
    auto& [ow, ox, oy, oz] = lattice.bodies.orientation[b];
    const Quat<double> turned = product(q, Quat<double>{ow, ox, oy, oz});
    lattice.bodies.orientation[b] = {turned.w, turned.x, turned.y, turned.z};
  }
  for (auto& [x, y, z] : lattice.beams.axis_y) {
    const Vec3<double> moved = rotate(q, {x, y, z});
    x = moved.x, y = moved.y, z = moved.z;
  }
}

TEST(FloatingSheet, FindsItsDraftAndLevel) {
  Scene scene = bending_scene(20, 1, 2);
  scene.loads.clear();
  Lattice lattice = mesh_of(scene);
  place_elsewhere(lattice, 0.02, 0.15);
  const StaticSolution s = solve_static(scene, lattice);
  ASSERT_TRUE(s.result.done);
  const double draft = scene.thickness * scene.ice.density / scene.water_density;
  double departure = 0, mean = 0;
  for (std::size_t b = 0; b < lattice.bodies.position.size(); ++b) {
    const double middle = lattice.bodies.position[b][2] + displacement(s.last(), b).z;
    mean += (scene.thickness / 2 - middle) / lattice.bodies.size();
    departure = std::max(departure, std::abs(scene.thickness / 2 - middle - draft));
  }
  verify({.section = section_name,
          .quantity = "draft found from 0.15 m too high and tilted by 0.02",
          .value = mean,
          .reference = draft,
          .tolerance = 1e-8,
          .unit = "m",
          .note = "h rho_i/rho_w; every body to 1e-8 m"});
  EXPECT_LE(departure, 1e-8);
}

TEST(FloatingSheet, SmallStiffSheetSinksAsARigidBody) {
  for (const double length : {10.0, 20.0}) {
    Scene scene = bending_scene(length, 1.5, 3);
    scene.ice.young = 4e15;
    const StaticSolution s = solve_static(scene, mesh_of(scene));
    ASSERT_TRUE(s.result.done);
    const Wyman wyman = Wyman::of_material(scene);
    const double expected = 8 * wyman.characteristic * wyman.characteristic / (length * length);
    verify({.section = section_name,
            .quantity = text("rigid sinking, L=%g h=1.5, E = 4e15 Pa: w L^2/(8 l_c^2 w0)", length),
            .value = deflection_under_load(s) / wyman.centre / expected,
            .reference = 1.0,
            .tolerance = 1e-3});
  }
}

/// A moment M tilts a rigid sheet by M/(rho_w g (I + V (z_B - z_G))).
TEST(FloatingSheet, StiffnessAgainstTilting) {
  const double length = 20, width = 12, h = 1.5;
  for (const bool about_x : {true, false}) {
    Scene scene = bending_scene(length, h, 3);
    scene.sheet.width = width;
    scene.ice.young = 4e15;
    const double k = scene.water_density * scene.gravity,
                 draft = h * scene.ice.density / scene.water_density;
    const double second_moment =
        (about_x ? length * width * width * width : width * length * length * length) / 12;
    const double stiffness = k * (second_moment + length * width * draft * (draft / 2 - h / 2));
    const double angle = 1e-4;
    Load& moment = scene.loads[0];
    moment.point.reset();
    moment.set = "all";
    moment.force = {};
    moment.moment = about_x ? Point3{stiffness * angle, 0, 0} : Point3{0, stiffness * angle, 0};
    const StaticSolution s = solve_static(scene, mesh_of(scene));
    ASSERT_TRUE(s.result.done);
    const Vec3<double> turned = log_rotation(rotation(s.last(), 0));
    verify({.section = section_name,
            .quantity = std::string("tilt of a rigid sheet about ") + (about_x ? "x" : "y") +
                        " over the expected",
            .value = (about_x ? turned.x : turned.y) / angle,
            .reference = 1.0,
            .tolerance = 1e-4,
            .note = "M/(rho_w g (I + V (z_B - z_G)))"});
  }
}

// -- the table ------------------------------------------------------------------------------------

struct Row {
  double length, thickness;
  int times;  ///< l = times h
  double saint_venant, polar;
  bool quick;  ///< in the short form too
};

constexpr Row rows[] = {
    {20, 1.5, 3, 7.14, 0, true},       {20, 1.5, 2, 7.15, 0, true},
    {80, 1.5, 3, 1.221, 1.168, true},  {40, 0.5, 3, 1.19, 0, false},
    {40, 0.5, 2, 1.21, 0, false},      {80, 1.5, 2, 1.249, 1.229, true},
    {160, 1.5, 3, 1.066, .990, true},  {160, 1.5, 2, 1.098, 1.070, false},
    {160, 1.0, 3, 1.051, .973, false}, {160, 1.0, 2, 1.088, 1.058, false},
};

class BendingTable : public testing::TestWithParam<Row> {};

TEST_P(BendingTable, MeanDeflectionUnderThePointLoad) {
  const Row& row = GetParam();
  if (!row.quick && !full_form()) GTEST_SKIP() << "in the full form only (FLOE_FULL=1)";
  const int meshes = 5;
  std::array<double, 2> sum{}, lowest{1e9, 1e9}, highest{};
  for (int seed = 1; seed <= meshes; ++seed) {
    const Scene scene = bending_scene(row.length, row.thickness, row.times * row.thickness,
                                      static_cast<std::uint64_t>(seed));
    Lattice lattice = mesh_of(scene);
    for (const std::size_t k : {0U, 1U}) {
      if (k == 1) {
        if (row.polar == 0) continue;
        for (std::size_t m = 0; m < lattice.beams.torsion.size(); ++m)
          lattice.beams.torsion[m] = lattice.beams.inertia_y[m] + lattice.beams.inertia_z[m];
      }
      const StaticSolution s = solve_static(scene, lattice);
      ASSERT_TRUE(s.result.done);
      const double ratio = deflection_under_load(s) / Wyman::of_material(scene).centre;
      sum[k] += ratio;
      lowest[k] = std::min(lowest[k], ratio);
      highest[k] = std::max(highest[k], ratio);
    }
  }
  for (const std::size_t k : {0U, 1U}) {
    const double reference = k == 0 ? row.saint_venant : row.polar;
    if (reference == 0) continue;
    verify({.section = section_name,
            .quantity = text("w/w0, L=%g h=%.1f l=%dh, %s", row.length, row.thickness, row.times,
                             k == 0 ? "saint_venant" : "polar"),
            .value = sum[k] / meshes,
            .reference = reference,
            .tolerance = 0.02,
            .note = text("%d meshes, %.3f to %.3f; one_point", meshes, lowest[k], highest[k])});
  }
}

INSTANTIATE_TEST_SUITE_P(Rows, BendingTable, testing::ValuesIn(rows), [](const auto& given) {
  return text("L%g_h%02.0f_l%dh", given.param.length, 10 * given.param.thickness,
              given.param.times);
});

// -- the profile ----------------------------------------------------------------------------------

/// Along X = 0, 0 <= Y <= L/2: bodies with their centroid within l/2 of it, each against Wyman at
/// its own distance from the load. The lattice's bending stiffness is D*, not its material's D;
/// what departs from the infinite plate of stiffness D* comes from the plate's shear, the mesh's
/// randomness and the sheet's finite size.
TEST(FloatingSheet, ProfileAgainstWyman) {
  const double length = 160, h = 1;
  for (const int times : {2, 3}) {
    if (times == 2 && !full_form()) continue;
    const Scene scene = bending_scene(length, h, times * h);
    const Lattice lattice = mesh_of(scene);
    const StaticSolution s = solve_static(scene, lattice);
    ASSERT_TRUE(s.result.done);
    const Wyman material = Wyman::of_material(scene), plate = Wyman::of_lattice(scene);
    double from_material = 0, from_plate = 0;
    int points = 0;
    for (std::size_t b = 0; b < lattice.bodies.position.size(); ++b) {
      const auto& [x, y, z] = lattice.bodies.position[b];
      if (std::abs(x) > scene.sheet.element_size / 2 || y < 0) continue;
      const double r = std::hypot(x, y);
      const double w = displacement(s.first(), b).z - displacement(s.last(), b).z;
      from_material = std::max(from_material, std::abs(w - material.at(r)) / material.centre);
      from_plate = std::max(from_plate, std::abs(w - plate.at(r)) / plate.centre);
      ++points;
    }
    const std::string name =
        text("profile, L=%g h=%g l=%dh: largest departure from Wyman", length, h, times);
    report({.section = section_name,
            .quantity = name + ", over w0",
            .value = from_material,
            .note = text("%d bodies along X = 0, seed 1", points)});
    verify({.section = section_name,
            .quantity = name + " with D* for D, over w0*",
            .value = from_plate,
            .reference = 0.0,
            .tolerance = 0.02,
            .note = text("D*/D = %.4f of the infinite regular lattice",
                         std::pow(plate.characteristic / material.characteristic, 4))});
  }
}

}  // namespace
}  // namespace floe::test
