// Static paths past limit points, with the load factor as an unknown: trusses in closed form, Lee's
// frame and the arch of DaDeppo & Schmidt against the rods' boundary-value problems.
#include "support/paths.h"

#include <algorithm>
#include <numbers>
#include <numeric>

#include "support/record.h"

namespace floe::test {
namespace {

constexpr double pi = std::numbers::pi;

// -- von Mises' truss -----------------------------------------------------------------------------

/// Two bars from hinges at (-1, 0), (1, 0) to an apex of height h, of negligible bending stiffness;
/// with a spring, a third bar from above the apex to a body that is moved.
struct Truss {
  double height = 0.25, spring = 0;
  double rest() const { return std::hypot(1, height); }
  /// Load P that holds the apex at w below its place, over EA:
  /// 2 (l0 - l)/l0 (h - w)/l (von Mises 1923).
  double load(double w) const {
    const double l = std::hypot(1, height - w);
    return 2 * (rest() - l) / rest() * (height - w) / l;
  }
  /// At the limit points l^3 = l0 (half span)^2.
  double limit_load() const {
    const double l = std::cbrt(rest());
    return 2 * (rest() - l) / rest() * std::sqrt(l * l - 1) / l;
  }
  Lattice lattice() const {
    const double thin = 1e-12;
    const FrameSection bar{1, thin, thin, thin, 1, 0.5, 5.0 / 6};
    std::vector<Point3> points{{-1, 0, 0}, {0, height, 0}, {1, 0, 0}};
    const double c = 1 / rest(), s = height / rest();
    Lattice lattice = frame(points, bar, {{-s, c, 0}, {s, c, 0}});
    if (spring > 0) {
      Lattice more = frame({{0, height, 0}, {0, height + 10, 0}}, bar, {{-1, 0, 0}});
      lattice.bodies.position.push_back(more.bodies.position[1]);
      lattice.bodies.orientation.push_back({1, 0, 0, 0});
      lattice.bodies.mass.push_back(1);
      lattice.bodies.inertia.push_back({1, 1, 1});
      Beams& b = lattice.beams;
      b.bodies.push_back({1, 3});
      b.area.push_back(10 * spring);
      b.inertia_y.push_back(thin), b.inertia_z.push_back(thin), b.torsion.push_back(thin);
      b.length.push_back(10), b.young.push_back(1), b.shear_modulus.push_back(0.5);
      b.shear_factor.push_back(5.0 / 6), b.axis_y.push_back({-1, 0, 0});
      lattice.sets["top"] = {3};
    }
    lattice.sets["apex"] = {1};
    return lattice;
  }
  Scene scene() const {
    Scene scene;
    scene.forces.beam = true;
    scene.beam.shear = Shear::none;
    scene.boundaries = {hinge("root"), hinge("tip")};
    return scene;
  }
};

TEST(PathOfTruss, IsExactPastBothLimitPoints) {
  const Truss truss;
  Scene scene = truss.scene();
  scene.loads = {dead_load("apex", {0, -truss.limit_load(), 0})};
  PathOptions<Planar> options;
  options.arc = options.arc_max = 0.004;
  options.load_factor = 2;
  const auto path = follow<Planar>(scene, truss.lattice(), std::move(options));
  ASSERT_TRUE(path.result.done) << path.result.message;
  double worst = 0;
  for (std::size_t k = 0; k < path.states.size(); ++k) {
    const double w = -displacement(path.states[k], 1).y;
    worst = std::max(
        worst, std::abs(path.columns[k].at("load_factor") - truss.load(w) / truss.limit_load()));
  }
  EXPECT_EQ(path.last("load_factor"), 2);
  EXPECT_GT(-displacement(path.states.back(), 1).y, 2 * truss.height);
  verify({.section = "Paths",
          .quantity = "von Mises truss, snap-through: largest error of the load factor on the path",
          .value = worst,
          .reference = 0.0,
          .tolerance = 1e-8,
          .note = text("%d states; relative to the limit load", path.states.size())});
  const auto& limits = path.result.path->limit_points;
  ASSERT_EQ(limits.size(), 2U);
  EXPECT_TRUE(limits[0].is_maximum);
  EXPECT_FALSE(limits[1].is_maximum);
  // The vertex of a parabola through three states is right to the third order of their distance.
  for (std::size_t k = 0; k < 2; ++k)
    verify({.section = "Paths",
            .quantity = std::string("von Mises truss: ") + (k == 0 ? "largest" : "least") +
                        " load over the exact limit load",
            .value = limits[k].load_factor,
            .reference = k == 0 ? 1.0 : -1.0,
            .tolerance = 1e-5});
  EXPECT_EQ(path.result.path->snap_backs, 0);
}

/// A soft spring in series: the top moves by U = w + P(w)/k, which falls where P' < -k.
TEST(PathOfTruss, SnapsBackBehindASpring) {
  Truss truss;
  truss.spring = 0.004;
  Scene scene = truss.scene();
  Boundary top = clamp("top");
  top.displacement = Point3{0, -1, 0};
  top.ramp.seconds = 1;
  scene.boundaries.push_back(top);
  PathOptions<Planar> options;
  options.arc = options.arc_max = 0.01;
  options.load_factor = 3;
  const auto path = follow<Planar>(scene, truss.lattice(), std::move(options));
  ASSERT_TRUE(path.result.done) << path.result.message;
  double worst = 0, work = 0;
  const std::vector<double> moved = path.column("load_factor"), back = path.column("snap_back");
  double force = 0;
  for (std::size_t k = 0; k < path.states.size(); ++k) {
    const double w = -displacement(path.states[k], 1).y;
    worst = std::max(worst, std::abs(moved[k] - (w + truss.load(w) / truss.spring)));
    const double next = truss.spring * (moved[k] - w);
    if (k > 0) work += 0.5 * (force + next) * (moved[k] - moved[k - 1]);
    force = next;
    EXPECT_EQ(back[k] != 0, k > 0 && moved[k] < moved[k - 1]) << k;
  }
  EXPECT_GT(std::accumulate(back.begin(), back.end(), 0.0), 3);
  verify({.section = "Paths",
          .quantity = "von Mises truss behind a spring, snap-back: largest error of the motion, m",
          .value = worst,
          .reference = 0.0,
          .tolerance = 1e-7,
          .note = text("%d states", path.states.size())});
  EXPECT_NEAR(path.last("energy_boundary"), work, 1e-10 * std::abs(work));
  // Work by the mean of the force over each step; strain energy is exact.
  EXPECT_NEAR(path.last("energy_boundary"), path.last("energy_strain"),
              1e-3 * path.last("energy_strain"));
}

TEST(PathOfTruss, GoesTheOtherWayToANegativeLoadFactor) {
  const Truss truss;
  Scene scene = truss.scene();
  scene.loads = {dead_load("apex", {0, -truss.limit_load(), 0})};
  PathOptions<Planar> options;
  options.load_factor = -1;
  const auto path = follow<Planar>(scene, truss.lattice(), std::move(options));
  ASSERT_TRUE(path.result.done) << path.result.message;
  const double w = -displacement(path.states.back(), 1).y;
  EXPECT_LT(w, 0);
  EXPECT_NEAR(truss.load(w), -truss.limit_load(), 1e-8 * truss.limit_load());
}

// -- Lee's frame ----------------------------------------------------------------------------------

PathSolution<Planar> lee_path(int elements, double arc, std::optional<double> load_factor,
                              std::optional<PathEnd<Planar>> end = {}) {
  PathOptions<Planar> options;
  options.arc = options.arc_max = arc;
  options.load_factor = load_factor;
  options.ends_at = std::move(end);
  auto path = follow<Planar>(lee_scene(), lee_frame(elements), std::move(options));
  EXPECT_TRUE(path.result.done) << path.result.message;
  return path;
}

TEST(LeeFrame, LimitLoadsConvergeToTheRodsInSecondOrder) {
  // The rods' boundary-value problem, integrated to 1e-10 along its own path; P L^2/EI. Published:
  // 18.5 and -9.4.
  constexpr std::array<double, 2> exact{18.5568, -9.4139};
  std::array<std::array<double, 2>, 3> found{};
  const std::array<int, 3> elements{10, 20, 40};
  for (std::size_t k = 0; k < elements.size(); ++k) {
    const auto path = lee_path(elements[k], 0.012, 20);
    const auto& limits = path.result.path->limit_points;
    ASSERT_EQ(limits.size(), 2U);
    EXPECT_TRUE(limits[0].is_maximum);
    found[k] = {limits[0].load_factor, limits[1].load_factor};
    EXPECT_GT(path.result.path->snap_backs, 3);
  }
  for (std::size_t k = 0; k < 2; ++k) {
    verify({.section = "Paths",
            .quantity =
                std::string("Lee's frame: ") + (k == 0 ? "largest" : "least") + " load P L^2/EI",
            .value = found[2][k],
            .reference = exact[k],
            .tolerance = 2e-3 * std::abs(exact[k]),
            .note = "80 beams"});
    const double order = std::log2((found[0][k] - found[1][k]) / (found[1][k] - found[2][k]));
    EXPECT_NEAR(order, 2, 0.2) << k;
  }
}

TEST(LeeFrame, ThePathDoesNotDependOnTheArcLength) {
  // Past the least load, where the displacement of the load is -0.7 m.
  const auto end = [] { return at_displacement<Planar>(12, 1, -0.7); };
  const auto fine = lee_path(10, 0.005, {}, end()), coarse = lee_path(10, 0.05, {}, end());
  EXPECT_GT(fine.states.size(), 3 * coarse.states.size());
  EXPECT_LT(fine.last("load_factor"), -5);
  EXPECT_NEAR(fine.last("load_factor"), coarse.last("load_factor"), 1e-6);
  EXPECT_NEAR(displacement(fine.states.back(), 12).y, -0.7, 1e-10);
  EXPECT_NEAR(displacement(coarse.states.back(), 12).y, -0.7, 1e-10);
  for (std::size_t b = 0; b < 21; ++b) {
    const Vec3<double> d =
        displacement(fine.states.back(), b) - displacement(coarse.states.back(), b);
    EXPECT_LT(std::sqrt(dot(d, d)), 1e-8) << b;
  }
}

/// The load's work by its mean over each step differs from the strain energy in the second order of
/// the steps.
TEST(LeeFrame, TheWorkOfTheLoadIsTheStrainEnergy) {
  std::array<double, 2> error{};
  for (std::size_t k = 0; k < 2; ++k) {
    const auto path =
        lee_path(10, k == 0 ? 0.012 : 0.006, {}, at_displacement<Planar>(12, 1, -0.7));
    error[k] =
        (path.last("energy_external") - path.last("energy_strain")) / path.last("energy_strain");
  }
  EXPECT_LT(std::abs(error[1]), 1e-3);
  EXPECT_NEAR(error[0] / error[1], 4, 1);
}

/// With linear kinematics the path is a straight line, and one factorisation serves all of it.
TEST(LeeFrame, IsALineWithLinearKinematics) {
  Scene scene = lee_scene();
  scene.beam.kinematics = Kinematics::linear;
  PathOptions<Planar> options;
  options.load_factor = 5;
  const auto path = follow<Planar>(scene, lee_frame(10), std::move(options));
  ASSERT_TRUE(path.result.done) << path.result.message;
  EXPECT_EQ(path.result.factorisations, 1);
  const double last = displacement(path.states.back(), 12).y;
  EXPECT_LT(last, 0);
  for (std::size_t k = 0; k < path.states.size(); ++k)
    EXPECT_NEAR(displacement(path.states[k], 12).y, last / 5 * path.columns[k].at("load_factor"),
                1e-9 * std::abs(last));
  EXPECT_NEAR(path.last("energy_external"), path.last("energy_strain"),
              1e-9 * path.last("energy_strain"));
}

/// In space, with six unknowns per body, the frame takes the same path.
TEST(LeeFrame, InSpaceItIsAsInThePlane) {
  PathOptions<Spatial> options;
  options.arc = options.arc_max = 0.02;
  options.load_factor = 20;
  const auto space = follow<Spatial>(lee_scene(), lee_frame(10), std::move(options));
  ASSERT_TRUE(space.result.done) << space.result.message;
  const auto plane = lee_path(10, 0.02, 20);
  const auto &one = space.result.path->limit_points, &other = plane.result.path->limit_points;
  ASSERT_EQ(one.size(), 2U);
  for (std::size_t k = 0; k < 2; ++k) EXPECT_NEAR(one[k].load_factor, other[k].load_factor, 1e-5);
  const Vec3<double> d =
      displacement(space.states.back(), 12) - displacement(plane.states.back(), 12);
  EXPECT_LT(std::sqrt(dot(d, d)), 1e-8);
}

/// Large rotations in space: the 45-degree bend under its full load, by load steps and by arcs.
TEST(PathInSpace, EndsWhereLoadStepsEnd) {
  FrameSection section;
  section.torsion = 1.0 / 6;
  const Lattice lattice = arc_frame(100, pi / 4, 16, section);
  Scene scene;
  scene.forces.beam = true;
  scene.beam.shear = Shear::exact;
  scene.boundaries = {clamp("root")};
  scene.loads = {dead_load("tip", {0, 0, 600})};
  scene.time.dt = 0.1;
  const StaticSolution steps = solve_static(scene, lattice);
  PathOptions<Spatial> options;
  options.load_factor = 1;
  const auto path = follow<Spatial>(scene, lattice, std::move(options));
  ASSERT_TRUE(path.result.done) << path.result.message;
  EXPECT_GT(path.states.size(), 5U);
  for (std::size_t b = 0; b <= 16; ++b) {
    const Vec3<double> d = displacement(steps.last(), b) - displacement(path.states.back(), b);
    EXPECT_LT(std::sqrt(dot(d, d)), 1e-6) << b;
  }
  EXPECT_NEAR(path.last("energy_strain"), steps.columns.at("energy_strain"),
              1e-7 * path.last("energy_strain"));
}

// -- the arch of DaDeppo & Schmidt ----------------------------------------------------------------

/// 215 degrees of a circle of R = 100, EI = 1e6, hinged at the left end, clamped at the right one.
Lattice deep_arch(int elements) {
  const FrameSection section{100, 0.1, 0.1, 0.1, 1e7, 5e6, 5.0 / 6};
  std::vector<Point3> points, axis_y;
  const double half = 215.0 / 360 * pi, step = 2 * half / elements;
  for (int k = 0; k <= elements; ++k) {
    const double phi = step * k - half, middle = phi - step / 2;
    points.push_back({100 * std::sin(phi), 100 * (std::cos(phi) - 1), 0});
    if (k > 0) axis_y.push_back({std::sin(middle), std::cos(middle), 0});
  }
  Lattice lattice = frame(points, section, axis_y);
  lattice.sets["crown"] = {elements / 2};
  return lattice;
}

PathSolution<Planar> arch_path(int elements, double deflection) {
  Scene scene;
  scene.forces.beam = true;
  scene.beam.shear = Shear::none;
  scene.boundaries = {hinge("root"), clamp("tip")};
  scene.loads = {dead_load("crown", {0, -100, 0})};  // the load factor is P R^2/EI
  PathOptions<Planar> options;
  options.ends_at = at_displacement<Planar>(static_cast<std::size_t>(elements / 2), 1, -deflection);
  auto path = follow<Planar>(scene, deep_arch(elements), std::move(options));
  EXPECT_TRUE(path.result.done) << path.result.message;
  return path;
}

/// Points of the inextensible rod's boundary-value problem (EA R^2/EI = 1e8, integrated to 1e-10):
/// before the limit point and after it.
TEST(DeepArch, FollowsTheRodBeyondItsLimitLoad) {
  struct Point {
    double deflection, load, sway;
  };
  for (const auto& [deflection, load, sway] : {Point{112.38572732, 8.9576637374, 60.708535354},
                                               Point{119.91016655, 7.3856685181, 64.446203909}}) {
    std::array<double, 2> loads{}, sways{};
    const std::array<int, 2> elements{60, 120};
    for (std::size_t k = 0; k < elements.size(); ++k) {
      const auto path = arch_path(elements[k], deflection);
      loads[k] = path.last("load_factor");
      sways[k] = -displacement(path.states.back(), static_cast<std::size_t>(elements[k] / 2)).x;
      const auto& limits = path.result.path->limit_points;
      ASSERT_EQ(limits.size(), deflection > 115 ? 1U : 0U);
      if (k < 1 || limits.empty()) continue;
      verify({.section = "Paths",
              .quantity = "arch of DaDeppo & Schmidt: limit load P R^2/EI",
              .value = limits[0].load_factor,
              .reference = 8.97,
              .tolerance = 0.01,
              .note = "120 beams"});
    }
    verify(
        {.section = "Paths",
         .quantity = text("arch of DaDeppo & Schmidt, deflection %.3f: load P R^2/EI", deflection),
         .value = loads[1],
         .reference = load,
         .tolerance = 0.01 * load,
         .note = "120 beams"});
    verify({.section = "Paths",
            .quantity = text("arch of DaDeppo & Schmidt, deflection %.3f: sway, m", deflection),
            .value = sways[1],
            .reference = sway,
            .tolerance = 1e-3 * sway,
            .note = "120 beams"});
    EXPECT_NEAR(std::log2(std::abs((loads[0] - load) / (loads[1] - load))), 2, 0.2);
    EXPECT_NEAR(std::log2(std::abs((sways[0] - sway) / (sways[1] - sway))), 2, 0.3);
  }
}

}  // namespace
}  // namespace floe::test
