// Beams as frames: closed forms of small deflection, large rotations in the plane and in space,
// Newton's convergence (answers: input/verify).
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <numbers>

#include "support/frames.h"
#include "support/record.h"
#include "support/static_solution.h"

namespace floe::test {
namespace {

constexpr double pi = std::numbers::pi;

/// Clamped at its root, a dead force and moment at its tip that reach their full size at time 1.
Scene cantilever(Shear shear, const Point3& force, const Point3& moment, double dt = 0) {
  Scene scene;
  scene.forces.beam = true;
  scene.beam.shear = shear;
  Boundary root;
  root.name = root.set = "root";
  root.fixed.fill(true);
  Load tip;
  tip.name = tip.set = "tip";
  tip.force = force;
  tip.moment = moment;
  tip.ramp.seconds = 1;
  scene.boundaries = {root};
  scene.loads = {tip};
  scene.time.dt = dt;
  return scene;
}

Vec3<double> tip_displacement(const Lattice& lattice, const State<Spatial>& state) {
  return displacement(state, static_cast<std::size_t>(lattice.sets.at("tip")[0]));
}

// -- small deflections ----------------------------------------------------------------------------

/// Flexibility of the tip of a cantilever of n beams, in its own axes: rows displacement and
/// rotation (x y z rx ry rz) for a unit force and moment. With shear springs k_s and bending
/// moments taken at each beam's middle, the tip's flexibility in bending is L^3/(3EI) - L^3/(12 n^2
/// EI) + n/k_s: Timoshenko's L^3/(3EI) + L/(kappa G A) for `exact`, Euler's L^3/(3EI) for `none`,
/// both exact for any n.
std::array<std::array<double, 6>, 6> tip_flexibility(const FrameSection& s, double length, int n,
                                                     Shear shear) {
  std::array<std::array<double, 6>, 6> f{};
  const auto translation = [&](double inertia) {
    const double bending = length * length * length / (3 * s.young * inertia);
    const double sliding = length / (s.shear_factor * s.shear_modulus * s.area);
    if (shear == Shear::none) return bending;
    return shear == Shear::exact ? bending + sliding : bending * (1 - 0.25 / (n * n)) + sliding;
  };
  const double ey = s.young * s.inertia_y, ez = s.young * s.inertia_z;
  f[0][0] = length / (s.young * s.area);
  f[1][1] = translation(s.inertia_z);
  f[2][2] = translation(s.inertia_y);
  f[3][3] = length / (s.shear_modulus * s.torsion);
  f[4][4] = length / ey;
  f[5][5] = length / ez;
  f[1][5] = f[5][1] = length * length / (2 * ez);
  f[2][4] = f[4][2] = -length * length / (2 * ey);
  return f;
}

/// A beam's direction and axis 2.
struct Placing {
  const char* name;
  Point3 along, axis_y;
};

TEST(Cantilever, TipFlexibilityOfEveryLoadInEveryDirection) {
  const double length = 3;
  // All sections differ, so that no two stiffnesses can be taken for each other.
  const FrameSection section{0.12, 4e-4, 3e-3, 1.1e-3, 4e9, 1.5e9, 0.8};
  const double a = 1 / std::sqrt(3.0), b = 1 / std::sqrt(2.0), c = 1 / std::sqrt(6.0);
  const Placing placings[] = {
      {"x", {1, 0, 0}, {0, 1, 0}},        {"-x", {-1, 0, 0}, {0, 1, 0}},
      {"y", {0, 1, 0}, {-1, 0, 0}},       {"z", {0, 0, 1}, {0, 1, 0}},
      {"oblique", {a, a, a}, {b, -b, 0}}, {"oblique and turned", {a, -a, a}, {c, 2 * c, c}}};
  for (const Shear shear : all_shears) {
    for (const int elements : {1, 4}) {
      for (const Kinematics kinematics : {Kinematics::corotational, Kinematics::linear}) {
        const auto exact = tip_flexibility(section, length, elements, shear);
        double largest = 0;
        for (const Placing& placing : placings) {
          const Lattice lattice =
              straight_frame(length, elements, section, placing.along, placing.axis_y);
          const Triad<double> axes{placing.along, placing.axis_y,
                                   cross(placing.along, placing.axis_y)};
          for (std::size_t load = 0; load < 6; ++load) {
            // Small enough that products of rotations do not show, large enough that rounding does
            // not.
            const double size = 1e-8 / exact[load][load];
            const std::array<Vec3<double>, 3> e{axes.e1, axes.e2, axes.e3};
            const Vec3<double> vector = size * e[load % 3];
            Scene scene = load < 3 ? cantilever(shear, vector, {}) : cantilever(shear, {}, vector);
            scene.beam.kinematics = kinematics;
            const StaticSolution solution = solve_static(scene, lattice);
            ASSERT_TRUE(solution.result.done) << placing.name << " " << load;
            const Quat<double> q = rotation(solution.last(), static_cast<std::size_t>(elements));
            const Vec3<double> u = axes.to_local(tip_displacement(lattice, solution.last()));
            const Vec3<double> r = axes.to_local(Vec3<double>{2 * q.x, 2 * q.y, 2 * q.z});
            const std::array<double, 6> moved{u.x, u.y, u.z, r.x, r.y, r.z};
            for (std::size_t k = 0; k < 6; ++k) {
              const double scale = std::sqrt(exact[k][k] * exact[load][load]);
              const double error = std::abs(moved[k] / size - exact[k][load]) / scale;
              EXPECT_LE(error, 1e-6) << placing.name << ", load " << load << ", motion " << k;
              largest = std::max(largest, error);
            }
          }
        }
        verify({.section = "Beams",
                .quantity = "cantilever, " + name_of(shear) +
                            text(", %d beam%s", elements, elements > 1 ? "s" : "") +
                            (kinematics == Kinematics::linear ? ", linear" : "") +
                            ": largest error of the tip's 6 x 6 flexibility",
                .value = largest,
                .reference = 0.0,
                .tolerance = 1e-6,
                .note = "closed form; six directions of the beam; relative to the diagonal"});
      }
    }
  }
}

// -- large rotations in a plane -------------------------------------------------------------------

/// Under an end moment, n beams become part of a regular polygon: body i has turned by i phi, beam
/// i stands at (i + 1/2) phi. With n phi = 2 pi it closes.
TEST(RollUp, TipFollowsTheRegularPolygonAndCloses) {
  const double length = 10, ei = 100;
  const int elements = 40;
  const FrameSection section{1, ei / 1200, ei / 1200, 1.0 / 6, 1200, 600, 5.0 / 6};
  const Lattice lattice = straight_frame(length, elements, section);
  const double moment = 4 * pi * ei / length;  // twice round
  std::map<double, double> largest;  // by turns: distance of the tip from the polygon's, over L
  for (const bool in_plane : {true, false}) {
    for (const Shear shear : all_shears) {
      const Point3 about = in_plane ? Point3{0, 0, moment} : Point3{0, -moment, 0};
      const StaticSolution solution = solve_static(cantilever(shear, {}, about, 0.05), lattice);
      ASSERT_TRUE(solution.result.done);
      for (const double turns : {0.2, 0.5, 1.0, 1.5, 2.0}) {
        const auto found = std::find_if(
            solution.states.begin(), solution.states.end(),
            [&](const State<Spatial>& s) { return std::abs(s.time - turns / 2) < 1e-9; });
        ASSERT_NE(found, solution.states.end());
        const double angle = 2 * pi * turns, phi = angle / elements;
        const double chord = length / elements * std::sin(angle / 2) / std::sin(phi / 2);
        const double x = chord * std::cos(angle / 2), y = chord * std::sin(angle / 2);
        const Vec3<double> u = tip_displacement(lattice, *found);
        const double up = in_plane ? u.y : u.z, across = in_plane ? u.z : u.y;
        const double error = std::hypot(length + u.x - x, up - y, across) / length;
        EXPECT_LE(error, 1e-6) << turns << " " << name_of(shear) << " " << in_plane;
        largest[turns] = std::max(largest[turns], error);
      }
    }
  }
  for (const auto& [turns, error] : largest) {
    verify(
        {.section = "Beams",
         .quantity = text("roll-up to %g turns: tip from the polygon's, over L", turns),
         .value = error,
         .reference = 0.0,
         .tolerance = 1e-6,
         .note = text("M = %g x 2 pi EI/L, %d beams, about y and z, all shears", turns, elements)});
  }
}

TEST(Elastica, TipUnderDeadLoad) {
  const double length = 10;
  const int elements = 64;
  const double side = 0.01, inertia = side * side * side * side / 12;
  const FrameSection section{side * side, inertia,   inertia, 2 * inertia,
                             2.1e11,      8.0769e10, 5.0 / 6};
  const double ei = section.young * inertia;
  const Lattice lattice = straight_frame(length, elements, section);
  const Scene scene = cantilever(Shear::exact, {0, 10 * ei / (length * length), 0}, {}, 0.1);
  const StaticSolution solution = solve_static(scene, lattice);
  ASSERT_TRUE(solution.result.done);
  struct Exact {
    double load, shortening, rise;
  };
  for (const auto& [load, shortening, rise] :
       {Exact{1, .05643, .30172}, Exact{2, .16064, .49346}, Exact{5, .38763, .71379},
        Exact{10, .55500, .81061}}) {
    const State<Spatial>& state = solution.states[static_cast<std::size_t>(load)];
    ASSERT_NEAR(state.time, load / 10, 1e-12);
    const Vec3<double> u = tip_displacement(lattice, state);
    // 0.05 % of the tip's way; each number of the reference has five digits after the point.
    const double tolerance = 5e-4 * std::hypot(shortening, rise);
    verify({.section = "Beams",
            .quantity = text("elastica, P L^2/EI = %g: 1 - x/L", load),
            .value = -u.x / length,
            .reference = shortening,
            .tolerance = tolerance,
            .note = text("%d beams, exact", elements)});
    verify({.section = "Beams",
            .quantity = text("elastica, P L^2/EI = %g: y/L", load),
            .value = u.y / length,
            .reference = rise,
            .tolerance = tolerance,
            .note = text("%d beams, exact", elements)});
  }
}

// -- large rotations in space ---------------------------------------------------------------------

/// 45-degree bend (Bathe & Bolourchi 1979): R = 100, section 1 x 1, E = 1e7, nu = 0, dead load in z
/// at the tip.
Lattice bend45(int elements, double gj) {
  FrameSection section;
  section.torsion = gj / section.shear_modulus;
  return arc_frame(100, pi / 4, elements, section);
}

/// Reference: the rod's boundary-value problem integrated to 1e-9, given to four digits after the
/// point.
struct Bend {
  double gj, load;
  Vec3<double> tip;
};
const Bend bends[] = {{1e7 / 12, 600, {-23.5606, -13.6047, 53.4755}},
                      {7.05e5, 600, {-23.8142, -13.7291, 53.6055}},
                      {1e7 / 12, 300, {-11.9318, -7.0447, 40.1925}}};

/// The y displacement of the reference is negative where the curve bends to +y.
Vec3<double> bend_tip(int elements, const Bend& bend) {
  const Lattice lattice = bend45(elements, bend.gj);
  const StaticSolution solution =
      solve_static(cantilever(Shear::exact, {0, 0, bend.load}, {}, 0.25), lattice);
  return tip_displacement(lattice, solution.last());
}

TEST(Bend45, ConvergesToTheRodInSecondOrder) {
  for (const Bend& bend : bends) {
    const std::string name = text("45-degree bend, GJ = %.4g, P = %g", bend.gj, bend.load);
    std::array<Vec3<double>, 4> tips{};
    const std::array<int, 4> elements{8, 16, 32, 64};
    for (std::size_t k = 0; k < 4; ++k) tips[k] = bend_tip(elements[k], bend);
    const Vec3<double>& finest = tips[3];
    for (std::size_t k = 0; k < 3; ++k) {
      verify({.section = "Beams",
              .quantity = name + ": tip " + "xyz"[k],
              .value = finest[k],
              .reference = bend.tip[k],
              .tolerance = 5e-4 * std::abs(bend.tip[k]),
              .unit = "m",
              .note = "64 beams, exact"});
    }
    for (std::size_t k = 0; k < 4; ++k) {
      report({.section = "Beams",
              .quantity = name + text(": error with %d beams", elements[k]),
              .value = length(tips[k] - bend.tip),
              .unit = "m"});
    }
    // The reference ends at the fourth digit, so the finest order is taken from differences between
    // the frames.
    for (std::size_t k = 0; k < 2; ++k) {
      const double order =
          std::log2(length(tips[k] - tips[k + 1]) / length(tips[k + 1] - tips[k + 2]));
      verify({.section = "Beams",
              .quantity = name + text(": order from %d, %d and %d beams", elements[k],
                                      elements[k + 1], elements[k + 2]),
              .value = order,
              .reference = 2.0,
              .tolerance = 0.1});
    }
  }
}

// -- Newton ---------------------------------------------------------------------------------------

/// Residual norms of the last SNES solve in a file that -snes_monitor wrote.
std::vector<double> last_residuals(const std::string& file) {
  std::vector<double> norms;
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    int iteration = 0;
    double norm = 0;
    if (std::sscanf(line.c_str(), " %d SNES Function norm %lf", &iteration, &norm) != 2) continue;
    if (iteration == 0) norms.clear();
    norms.push_back(norm);
  }
  return norms;
}

/// Residuals over the load, step by step, of the last load step of a cantilever.
std::vector<double> residuals(const Lattice& lattice, const Scene& scene, double load) {
  const std::string file =
      std::filesystem::temp_directory_path() / ("floe_residuals_" + std::to_string(getpid()));
  const PetscOption each("-snes_lag_jacobian", "1"), monitor("-snes_monitor", "ascii:" + file);
  EXPECT_TRUE(solve_static(scene, lattice).result.done);
  std::vector<double> norms = last_residuals(file);
  std::filesystem::remove(file);
  for (double& norm : norms) norm /= load;
  return norms;
}

/// A frame of stocky beams, whose axial and bending stiffnesses are alike as in a sheet, bent far
/// in space by one load step. (In a slender frame the axial part of the residual, EA times a
/// squared rotation error, hides the order.)
TEST(Newton, ConvergesQuadraticallyWithTheExactTangent) {
  FrameSection section;
  section.area = 0.05;
  const int elements = 4;
  const double length = 10, ei = section.young * section.inertia_z,
               load = 2 * ei / (length * length);
  const std::vector<double> norms =
      residuals(straight_frame(length, elements, section),
                cantilever(Shear::exact, {0, load, load / 2}, {}), load);
  constexpr double rounding = 1e-13;  // of the load: residuals below it are not Newton's
  double largest_ratio = 0, after = 1;
  std::string all;
  for (std::size_t k = 0; k < norms.size(); ++k) {
    all += text("%s%.2g", k == 0 ? "" : ", ", norms[k]);
    if (k > 0 && norms[k] > rounding)
      largest_ratio = std::max(largest_ratio, norms[k] / (norms[k - 1] * norms[k - 1]));
    if (k >= 2 && norms[k - 2] > 1e-2 && norms[k - 2] < 1e-1) after = norms[k];
  }
  verify({.section = "Beams",
          .quantity = "Newton: largest |r_{k+1}|/|r_k|^2, residuals over the load",
          .value = largest_ratio,
          .reference = 0.0,
          .tolerance = 10.0,
          .note = "|r| = " + all + "; cantilever bent in space, P L^2/EI = 2, one load step"});
  verify({.section = "Beams",
          .quantity = "Newton: residual two iterations after one of 1e-2 to 1e-1, over the load",
          .value = after,
          .reference = 0.0,
          .tolerance = 1e-7});
}

}  // namespace
}  // namespace floe::test
