// First failure of a floating strip that is pushed against a slope (model.md, "Contact").

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "contact_laws/restitution.h"
#include "explicit/explicit.h"
#include "fracture/fracture.h"
#include "scene_model/scene_model.h"
#include "support/blocks.h"
#include "support/record.h"

namespace floe {
namespace {

constexpr double young = 4e9, strength = 5e5, friction = 0.1, water = 1010, ice = 920, g = 9.81;
constexpr double spacing = 1;  // of the bodies, and the strip's width [m]

struct Case {
  double thickness, angle;  // [m, degrees]
  double end;               // soon after the break [s]
};

/// A row of 120 boxes at its draft that ends at x = 0, neighbours joined across their facets.
Lattice strip(double h) {
  constexpr int n = 120;
  Lattice row;
  for (int k = 0; k < n; ++k)
    test::append_block(row, {spacing, spacing, h},
                       {(k + 0.5 - n) * spacing, 0, h * (0.5 - ice / water)});
  Beams& b = row.beams;
  for (std::int32_t k = 0; k + 1 < n; ++k) {
    b.bodies.push_back({k, k + 1});
    b.area.push_back(spacing * h), b.width.push_back(spacing), b.height.push_back(h);
    b.inertia_y.push_back(spacing * h * h * h / 12), b.inertia_z.push_back(h * spacing / 12);
    b.torsion.push_back(saint_venant_torsion(spacing, h)), b.length.push_back(spacing);
    b.young.push_back(young), b.shear_modulus.push_back(young / 2.6);
    b.shear_factor.push_back(5.0 / 6), b.axis_y.push_back({0, 1, 0});
  }
  row.sets["left"] = {0};
  return row;
}

/// The far end moves in x at 0.02 m/s; the near one meets the slope with its lower edge.
Scene push(const Case& c) {
  Scene scene;
  scene.integrator = Integrator::explicit_;
  scene.forces.beam = scene.forces.fracture = scene.forces.gravity = true;
  scene.forces.buoyancy = scene.forces.drag = scene.forces.contact = true;
  scene.beam.damping_ratio = 0.05;
  scene.fracture.tensile_strength = strength;
  scene.fracture.shear_strength = 10 * strength;
  scene.drag.linear = 1000;
  scene.contact.young = 4e8;
  scene.contact.friction = friction;
  scene.contact.damping_ratio = damping_ratio_of(0.3);
  const double alpha = c.angle * std::numbers::pi / 180;
  constexpr double clear = 1e-3;
  scene.obstacles = {
      half_space({clear, 0, -c.thickness * ice / water}, {-std::sin(alpha), 0, std::cos(alpha)})};
  scene.obstacles[0].name = "slope";
  scene.obstacles[0].friction = friction;
  Boundary far;
  far.name = far.set = "left";
  far.fixed[0] = true;
  far.velocity = Point3{0.02, 0, 0};
  far.ramp.seconds = 2;
  scene.boundaries = {far};
  return scene;
}

/// What history.csv would hold, every 0.01 s, and where the first beam broke.
struct Pushed {
  std::vector<double> time, horizontal, vertical, broken;
  double place = 0, balance_error = 0, external = 0;
};
Pushed run(const Case& c) {
  const Scene scene = push(c);
  const Lattice lattice = strip(c.thickness);
  Model<Spatial> model(lattice, PETSC_COMM_SELF, scene.boundaries);
  add_forces(scene, {}, model, &lattice);
  add_contact(scene, lattice, model);
  ExplicitOptions options;
  options.end = c.end;
  options.history = 0.01;
  Pushed p;
  const RunResult result = run_explicit(model, options, [&](const Accepted<Spatial>& a) {
    p.time.push_back(a.state.time);
    for (const auto* list : {&a.columns, &a.forces}) {
      for (const auto& [name, value] : *list) {
        if (name == "slope_force_x") p.horizontal.push_back(value);
        if (name == "slope_force_z") p.vertical.push_back(-value);
        if (name == "beams_broken") p.broken.push_back(value);
        if (name == "energy_boundary") p.external = value;
        if (name == "energy_balance_error") p.balance_error = std::abs(value);
      }
    }
  });
  EXPECT_TRUE(result.done) << result.message;
  const std::vector<Break> breaks = model.fracture()->breaks();
  const auto first = std::min_element(
      breaks.begin(), breaks.end(), [](const Break& a, const Break& b) { return a.time < b.time; });
  EXPECT_NE(first, breaks.end());
  if (first != breaks.end()) p.place = -first->place[0];
  return p;
}

/// Load per width and place at which the largest tension 6M/h^2 - H/h in a semi-infinite beam on
/// water is the strength: M = (H/(xi lambda)) e^-lx sin lx - (H h/2) e^-lx (cos lx + sin lx), where
/// the edge carries V = H/xi and, since H acts at the lower edge, the moment H h/2.
struct Failure {
  double load = 0, place = 0, ratio = 0;  // H [N/m], [m], H/V
};
Failure first_failure(const Case& c) {
  const double alpha = c.angle * std::numbers::pi / 180, h = c.thickness;
  const double xi = (std::sin(alpha) + friction * std::cos(alpha)) /
                    (std::cos(alpha) - friction * std::sin(alpha));
  const double lambda = std::pow(water * g / (4 * young * h * h * h / 12), 0.25);
  Failure worst{0, 0, xi};
  double most = 0;
  for (double x = 0; x < 3 / lambda; x += 1e-3) {
    const double l = lambda * x;
    const double moment = std::exp(-l) * (std::sin(l) / (xi * lambda) -
                                          0.5 * h * (std::cos(l) + std::sin(l)));  // of H = 1
    const double tension = 6 * moment / (h * h) - 1 / h;
    if (tension <= most) continue;
    most = tension;
    worst.place = x;
  }
  worst.load = strength / most;
  return worst;
}

TEST(IceSlope, StripBreaksAtTheLoadOfABeamOnWater) {
  for (const Case& c : {Case{0.5, 45, 6.8}, {0.5, 60, 4.7}, {1, 45, 9.2}, {1, 60, 6.2}}) {
    const Pushed p = run(c);
    const Failure expected = first_failure(c);
    const std::size_t n = static_cast<std::size_t>(
        std::find_if(p.broken.begin(), p.broken.end(), [](double b) { return b > 0; }) -
        p.broken.begin());
    ASSERT_TRUE(n > 100 && n < p.broken.size());
    const auto mean = [&](const std::vector<double>& values, double part) {
      double sum = 0, count = 0;
      for (std::size_t k = 0; k < n; ++k) {
        if (p.time[k] < (1 - part) * p.time[n - 1]) continue;
        sum += values[k];
        ++count;
      }
      return sum / count;
    };
    const std::string what = test::text(", h = %g m, slope %g degrees", c.thickness, c.angle);
    const char* section = "Ice against a slope";
    // The load grows in proportion to the way, so its mean over the last tenth is 5 to 8 % below
    // that at the break.
    test::verify({.section = section,
                  .quantity = "first failure of a strip: H, mean of the last tenth of the time, "
                              "over the closed form" +
                              what,
                  .value = mean(p.horizontal, 0.1) / spacing / expected.load,
                  .reference = 1,
                  .tolerance = 0.1});
    test::verify({.section = section,
                  .quantity = "the same, mean of the last hundredth" + what,
                  .value = mean(p.horizontal, 0.01) / spacing / expected.load,
                  .reference = 1,
                  .tolerance = 0.04});
    test::verify({.section = section,
                  .quantity = "distance of the break from the edge" + what,
                  .value = p.place,
                  .reference = expected.place,
                  .tolerance = 0.75 * spacing,
                  .unit = "m"});
    test::verify({.section = section,
                  .quantity = "H/V over that of a sliding contact" + what,
                  .value = mean(p.horizontal, 0.1) / mean(p.vertical, 0.1) / expected.ratio,
                  .reference = 1,
                  .tolerance = 0.01});
    EXPECT_LT(p.balance_error, 0.01 * p.external);
  }
}

/// The formula's own numbers [kN/m].
TEST(IceSlope, ClosedFormGivesThePublishedNumbers) {
  const std::array<double, 3> half{7.54, 11.46, 14.71}, whole{18.24, 27.94, 36.12};
  const std::array<double, 3> angles{45, 55, 60};
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(first_failure({0.5, angles[k], 0}).load / 1e3, half[k], 0.006);
    EXPECT_NEAR(first_failure({1, angles[k], 0}).load / 1e3, whole[k], 0.006);
  }
}

}  // namespace
}  // namespace floe
