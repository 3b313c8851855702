// Leapfrog: frequencies of a cantilever, speed of a wave along a sheet (model.md, "Effective moduli
// of the lattice, calibrated sheets" and "Explicit dynamics").
#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "stability/stable_step.h"
#include "support/dynamics.h"
#include "support/record.h"
#include "support/static_solution.h"

namespace floe::test {
namespace {

constexpr double pi = std::numbers::pi;
constexpr const char* section_name = "Explicit dynamics";

/// Transfer matrix of a Timoshenko beam with rotary inertia at angular frequency omega, on
/// (w, theta, M, Q): w' = theta + Q/(kappa G A), theta' = M/EI, M' = -Q - rho I omega^2 theta,
/// Q' = -rho A omega^2 w (Timoshenko 1921).
/// \param rotary  factor on the rotary inertia rho I
Eigen::Matrix4d transfer(const FrameSection& s, double density, double omega, double x,
                         double rotary) {
  Eigen::Matrix4d a = Eigen::Matrix4d::Zero();
  a(0, 1) = 1, a(0, 3) = 1 / (s.shear_factor * s.shear_modulus * s.area);
  a(1, 2) = 1 / (s.young * s.inertia_z);
  a(2, 1) = -rotary * density * s.inertia_z * omega * omega, a(2, 3) = -1;
  a(3, 0) = -density * s.area * omega * omega;
  // exp(a x) by Taylor on x/2^10, squared ten times; sizes are evened out by x itself.
  const Eigen::Matrix4d step = a * (x / 1024);
  Eigen::Matrix4d term = Eigen::Matrix4d::Identity(), sum = term;
  for (int k = 1; k < 20; ++k) {
    term = term * step / k;
    sum += term;
  }
  for (int k = 0; k < 10; ++k) sum = sum * sum;
  return sum;
}

/// Angular frequency of bending mode `mode` (1, 2, ...) clamped at 0 and free at L: M = Q = 0
/// there.
double timoshenko(const FrameSection& s, double density, double length, int mode,
                  double rotary = 1) {
  const auto determinant = [&](double omega) {
    const Eigen::Matrix4d t = transfer(s, density, omega, length, rotary);
    return t(2, 2) * t(3, 3) - t(2, 3) * t(3, 2);
  };
  const double euler = std::sqrt(s.young * s.inertia_z / (density * s.area)) / (length * length);
  const double step = 0.01 * euler;
  double low = step;
  for (int found = 0;; low += step) {
    if (determinant(low) * determinant(low + step) < 0 && ++found == mode) break;
  }
  double high = low + step;
  for (int k = 0; k < 60; ++k) {
    const double middle = 0.5 * (low + high);
    (determinant(low) * determinant(middle) <= 0 ? high : low) = middle;
  }
  return 0.5 * (low + high);
}

/// Angular frequency of `signal`, one value per dt, from its upward zero crossings.
double frequency(const std::vector<double>& signal, double dt) {
  double first = 0, last = 0;
  int crossings = 0;
  for (std::size_t n = 1; n < signal.size(); ++n) {
    if (!(signal[n - 1] < 0 && signal[n] >= 0)) continue;
    last = (static_cast<double>(n) - signal[n] / (signal[n] - signal[n - 1])) * dt;
    if (crossings++ == 0) first = last;
  }
  EXPECT_GE(crossings, 3);
  return 2 * pi * (crossings - 1) / (last - first);
}

TEST(Cantilever, VibratesAtTimoshenkosFrequencies) {
  // A short thick beam: shear lowers the second bending frequency by 30 % here.
  const double length = 8, density = 900;
  const FrameSection section{1.0, 1.0 / 12, 0.12, 0.14, 4e9, 1.5e9, 5.0 / 6};
  const int elements = 40;
  const double c = std::sqrt(section.young / density);
  const double polar = section.inertia_y + section.inertia_z;
  const double euler =
      std::sqrt(section.young * section.inertia_z / (density * section.area)) / (length * length);
  enum Kind { bending, axial, torsion };
  struct Mode {
    const char* name;
    Kind kind;
    double omega;
    double without;     // shear and rotary inertia
    double rotary = 1;  // factor on the moments of inertia of bodies
  };
  const Mode modes[] = {
      {"first bending", bending, timoshenko(section, density, length, 1), 3.51602 * euler},
      {"second bending", bending, timoshenko(section, density, length, 2), 22.0345 * euler},
      {"axial", axial, pi * c / (2 * length), 0},
      {"torsional", torsion,
       pi / (2 * length) * std::sqrt(section.shear_modulus * section.torsion / (density * polar)),
       0},
      {"first bending, moments of inertia times 4,", bending,
       timoshenko(section, density, length, 1, 4), 3.51602 * euler, 4},
      {"second bending, moments of inertia times 4,", bending,
       timoshenko(section, density, length, 2, 4), 22.0345 * euler, 4}};
  for (const Mode& mode : modes) {
    Lattice lattice = straight_frame(length, elements, section);
    give_mass(lattice, section, density);
    Bodies& bodies = lattice.bodies;
    for (Point3& moments : bodies.inertia) moments = mode.rotary * moments;
    std::vector<double> shape;  // v_y, v_x or spin about x
    const double speed = 1e-6;
    Eigen::Vector2d end{0, 0};  // M and Q at the root, up to a factor
    if (mode.kind == bending) {
      const Eigen::Matrix4d t = transfer(section, density, mode.omega, length, mode.rotary);
      end = {t(2, 3), -t(2, 2)};
    }
    for (const Point3& x : bodies.position) {
      bodies.velocity.push_back({0, 0, 0});
      bodies.angular_velocity.push_back({0, 0, 0});
      if (mode.kind == bending) {
        const Eigen::Vector4d at = transfer(section, density, mode.omega, x[0], mode.rotary) *
                                   Eigen::Vector4d{0, 0, end[0], end[1]};
        shape.push_back(at[0]);
        bodies.angular_velocity.back()[2] = at[1];
      } else {
        shape.push_back(std::sin(pi * x[0] / (2 * length)));
      }
    }
    const double scale = speed / std::abs(shape.back());
    for (std::size_t b = 0; b < shape.size(); ++b) {
      shape[b] *= scale;
      if (mode.kind == bending) bodies.velocity[b][1] = shape[b];
      if (mode.kind == axial) bodies.velocity[b][0] = shape[b];
      if (mode.kind == torsion) bodies.angular_velocity[b][0] = shape[b];
      bodies.angular_velocity[b][2] *= scale;
    }
    Scene scene = beams_only(Shear::exact);
    Boundary root;
    root.name = root.set = "root";
    root.fixed.fill(true);
    scene.boundaries = {root};
    Dynamics run(scene, lattice);
    const double period = 2 * pi / mode.omega;
    const double dt = std::min(0.9 * stable_step(run.model(), run.state()).dt, period / 200);
    run.set_step(dt);
    const int periods = full_form() ? 20 : 6;
    std::vector<double> signal;
    for (double t = 0; t < (periods + 0.6) * period; t += dt) {
      double sum = 0;
      for (std::size_t b = 0; b < shape.size(); ++b) {
        const double* r = run.state().record(b);
        const double at = mode.kind == bending ? r[1] : mode.kind == axial ? r[0] : r[4];
        sum += shape[b] * at * (mode.kind == torsion ? bodies.inertia[b][0] : bodies.mass[b]);
      }
      signal.push_back(sum);
      (void)run.step();
    }
    verify({.section = section_name,
            .quantity = std::string("cantilever: ") + mode.name + " frequency over Timoshenko's",
            .value = frequency(signal, dt) / mode.omega,
            .reference = 1.0,
            .tolerance = 0.005,
            .note = mode.without > 0 ? text("exact, %d beams; Euler-Bernoulli is at %.3f", elements,
                                            mode.without / mode.omega)
                                     : text("exact, %d beams", elements)});
  }
}

/// A strip of the regular lattice, of rows along x that are in turn `columns` and
/// `columns - 1` bodies long; sets `sides` (first and last row) and `ends`.
Lattice strip(int columns, int rows, double l, double h, const Ice& ice) {
  Lattice lattice;
  const double cell = std::sqrt(0.75) * l * l, full_mass = ice.density * cell * h;
  const auto share = [&](int r) { return r == 0 || r == rows - 1 ? 0.5 : 1.0; };
  std::vector<std::vector<std::int32_t>> number(static_cast<std::size_t>(rows));
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < columns - r % 2; ++c) {
      const std::int32_t body = lattice.bodies.size();
      const double mass = share(r) * full_mass;
      number[static_cast<std::size_t>(r)].push_back(body);
      lattice.bodies.position.push_back({l * (c + 0.5 * (r % 2)), std::sqrt(0.75) * l * r, 0});
      lattice.bodies.orientation.push_back({1, 0, 0, 0});
      lattice.bodies.mass.push_back(mass);
      // A hexagon's second moment is 5/36 A l^2/2 about an axis in its plane.
      const double flat = 5.0 / 72 * mass * l * l + mass * h * h / 12;
      lattice.bodies.inertia.push_back({flat, flat, 5.0 / 36 * mass * l * l});
      lattice.sets["all"].push_back(body);
    }
  }
  const double w = l / std::sqrt(3.0);
  struct Pair {
    std::int32_t i, j;
    double share;
  };
  std::vector<Pair> pairs;
  for (std::size_t r = 0; r < number.size(); ++r) {
    for (std::size_t c = 0; c < number[r].size(); ++c) {
      if (c + 1 < number[r].size())
        pairs.push_back({number[r][c], number[r][c + 1], share(static_cast<int>(r))});
      if (r + 1 == number.size()) continue;
      const auto& up = number[r + 1];
      const std::size_t right = r % 2 == 0 ? c : c + 1;
      if (right > 0) pairs.push_back({number[r][c], up[right - 1], 1});
      if (right < up.size()) pairs.push_back({number[r][c], up[right], 1});
    }
  }
  std::sort(pairs.begin(), pairs.end(),
            [](const Pair& a, const Pair& b) { return std::pair(a.i, a.j) < std::pair(b.i, b.j); });
  Beams& beams = lattice.beams;
  for (const auto& [i, j, part] : pairs) {
    const Point3 &p = lattice.bodies.position[static_cast<std::size_t>(i)],
                 &q = lattice.bodies.position[static_cast<std::size_t>(j)];
    beams.bodies.push_back({i, j});
    beams.area.push_back(part * w * h);
    beams.inertia_y.push_back(part * w * h * h * h / 12);
    beams.inertia_z.push_back(part * h * w * w * w / 12);
    beams.torsion.push_back(part * saint_venant_torsion(w, h));
    beams.length.push_back(l);
    beams.young.push_back(ice.young);
    beams.shear_modulus.push_back(ice.young / (2 * (1 + ice.poisson)));
    beams.shear_factor.push_back(5.0 / 6);
    beams.axis_y.push_back({-(q[1] - p[1]) / l, (q[0] - p[0]) / l, 0});
  }
  return lattice;
}

/// Standing longitudinal wave of a strip, first mode between free ends, no motion across: half a
/// wavelength is the strip's length. The strain across is 0, so the stress along is E*/(1 - nu*^2)
/// times the strain (plane stress through the thickness) and c = sqrt(E*/(rho (1 - nu*^2))): the
/// speed of a front in a sheet that is wide against the wave. (A strip that is narrow against it
/// contracts freely and has a bar's sqrt(E*/rho).)
TEST(Wave, RunsAtTheLatticesSpeed) {
  const Ice ice;
  const double l = 1, h = 0.5;
  for (const Shear shear : {Shear::one_point, Shear::exact}) {
    const double one_point = 5.0 / 6 / (2 * (1 + ice.poisson)), none = 1.0 / 3;
    const double r = shear == Shear::one_point ? one_point : one_point * none / (one_point + none);
    const double young = 2 * (1 + r) / (3 + r) * ice.young, poisson = (1 - r) / (3 + r);
    const int columns = 80, rows = 9;
    Lattice lattice = strip(columns, rows, l, h, ice);
    const double length = (columns - 0.5) * l;  // of the rows on the average
    const double wave = pi / length;
    std::vector<double> shape;
    for (const Point3& x : lattice.bodies.position) {
      shape.push_back(std::cos(wave * (x[0] - 0.5 * ((columns - 1) * l - length))));
      lattice.bodies.velocity.push_back({1e-6 * shape.back(), 0, 0});
      lattice.bodies.angular_velocity.push_back({0, 0, 0});
    }
    Scene scene = beams_only(shear);
    Boundary across;
    across.name = "across", across.set = "all";
    across.fixed[1] = true;
    scene.boundaries = {across};
    Dynamics run(scene, lattice);
    const double c = std::sqrt(young / ((1 - poisson * poisson) * ice.density));
    const double dt = 0.5 * stable_step(run.model(), run.state()).dt;
    run.set_step(dt);
    std::vector<double> signal;
    for (double t = 0; t < 3.6 * 2 * pi / (wave * c); t += dt) {
      double sum = 0;
      for (std::size_t b = 0; b < shape.size(); ++b) sum += shape[b] * run.state().record(b)[0];
      signal.push_back(sum);
      (void)run.step();
    }
    verify({.section = section_name,
            .quantity =
                "wave along a sheet, " + name_of(shear) + ": speed over sqrt(E*/(rho (1 - nu*^2)))",
            .value = frequency(signal, dt) / (wave * c),
            .reference = 1.0,
            .tolerance = 0.01,
            .note = text("plane stress, no strain across: %.0f m/s; a thin bar's is %.0f", c,
                         std::sqrt(young / ice.density))});
  }
}

/// Angular frequency of a standing bending wave of a strip of a sheet, half a wave long, its ends
/// free to rise but not to tilt, moments of inertia times `factor`.
double bending_frequency(double factor, double l, double h, int columns) {
  const Ice ice;
  const int rows = 5;
  Lattice lattice = strip(columns, rows, l, h, ice);
  const double length = (columns - 1) * l, wave = pi / length;
  std::vector<double> shape;
  for (std::size_t b = 0; b < lattice.bodies.position.size(); ++b) {
    const double x = lattice.bodies.position[b][0];
    lattice.bodies.inertia[b] = factor * lattice.bodies.inertia[b];
    shape.push_back(std::cos(wave * x));
    lattice.bodies.velocity.push_back({0, 0, 1e-6 * shape.back()});
    lattice.bodies.angular_velocity.push_back({0, 1e-6 * wave * std::sin(wave * x), 0});
    if (x > 0.1 * l && x < length - 0.1 * l) continue;
    lattice.sets["ends"].push_back(static_cast<std::int32_t>(b));
    lattice.bodies.mass[b] *= 0.5;  // the other half lies beyond the plane of symmetry
    lattice.bodies.inertia[b] = 0.5 * lattice.bodies.inertia[b];
  }
  Scene scene = beams_only(Shear::one_point);
  Boundary plane, ends;
  plane.name = "plane", plane.set = "all";
  for (const std::size_t k : {0, 1, 3, 5}) plane.fixed[k] = true;  // x, y, rx, rz
  ends.name = ends.set = "ends";
  ends.fixed[4] = true;
  scene.boundaries = {plane, ends};
  Dynamics run(scene, lattice);
  const double dt = 0.5 * stable_step(run.model(), run.state()).dt;
  run.set_step(dt);
  std::vector<double> signal;
  const double omega = wave * wave * std::sqrt(ice.young * h * h / (12 * (1 - 0.09) * ice.density));
  for (double t = 0; t < 8 * 2 * pi / omega; t += dt) {
    double sum = 0;
    for (std::size_t b = 0; b < shape.size(); ++b) sum += shape[b] * run.state().record(b)[2];
    signal.push_back(sum);
    (void)run.step();
  }
  return frequency(signal, dt);
}

/// model: rotational_inertia_factor f: bodies of mass m and moment I about an axis in the plane
/// have omega^2 (m + f I k^2) = stiffness (Rayleigh's rotary inertia; Timoshenko 1921 without its
/// shear, which adds (k h)^2 times less).
TEST(Wave, BendingSlowsWithTheMomentsOfInertia) {
  const double l = 1.5, h = 0.5, gyration2 = 5.0 / 72 * l * l + h * h / 12;
  for (const int columns : {9, 17}) {
    const double wave = pi / ((columns - 1) * l), one = bending_frequency(1, l, h, columns);
    for (const double factor : {2.0, 4.0}) {
      const double rotary = gyration2 * wave * wave;
      const double rayleigh = std::sqrt((1 + rotary) / (1 + factor * rotary));
      verify({.section = section_name,
              .quantity = text("bending wave of %.0f m, moments of inertia times %.0f: frequency "
                               "over that without",
                               2 * pi / wave, factor),
              .value = bending_frequency(factor, l, h, columns) / one,
              .reference = rayleigh,
              .tolerance = 0.05 * (1 - rayleigh),
              .note = text("Rayleigh's rotary inertia; l = %g m, h = %g m", l, h)});
    }
  }
}

}  // namespace
}  // namespace floe::test
