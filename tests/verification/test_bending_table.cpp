// Floating sheets (model.md, "Bending on water"): draft, stiffness against tilting, rigid sinking,
// and the deflection under a point load against an independent static solution and against Wyman's
// (1950) infinite plate.
#include <algorithm>
#include <array>
#include <cmath>

#include "support/bending.h"
#include "support/record.h"

namespace floe::test {
namespace {

constexpr const char* section_name = "Bending of a floating sheet";
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
    verify(
        {.section = section_name,
         .quantity = text("tilt of a rigid sheet about %s over the expected", about_x ? "x" : "y"),
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

/// The lattice's bending stiffness is D*, not its material's D;
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
    const Departure from_material = profile_departure(material, lattice, scene, s),
                    from_plate = profile_departure(plate, lattice, scene, s);
    const std::string name =
        text("profile, L=%g h=%g l=%dh: largest departure from Wyman", length, h, times);
    report({.section = section_name,
            .quantity = name + ", over w0",
            .value = from_material.largest,
            .note = text("%d bodies along X = 0, seed 1", from_material.points)});
    verify({.section = section_name,
            .quantity = name + " with D* for D, over w0*",
            .value = from_plate.largest,
            .reference = 0.0,
            .tolerance = 0.02,
            .note = text("D*/D = %.4f of the infinite regular lattice",
                         std::pow(plate.characteristic / material.characteristic, 4))});
  }
}

}  // namespace
}  // namespace floe::test
