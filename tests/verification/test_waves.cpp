// A floating strip in waves: its bending moments, and the height at which it breaks, against the
// theory of a beam on the water.
#include <gtest/gtest.h>

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <complex>
#include <vector>

#include "support/blocks.h"
#include "support/dynamics.h"
#include "support/record.h"

namespace floe {
namespace {

using Complex = std::complex<double>;
constexpr double g = 9.81, rho = 1000, pi = 3.14159265358979323846;

/// A strip 1 m wide of blocks 1 m long, half as heavy as the water.
struct Strip {
  int blocks = 48;
  double h = 0.4, young = 5e8, density = 500;
  double stiffness() const { return young * h * h * h / 12; }

  Lattice lattice() const {
    Lattice all;
    for (int b = 0; b < blocks; ++b)
      test::append_block(all, {1, 1, h}, {b - 0.5 * (blocks - 1), 0, 0}, {1, 0, 0, 0}, {}, {},
                         density);
    Beams& beams = all.beams;
    for (std::int32_t b = 0; b + 1 < blocks; ++b) {
      beams.bodies.push_back({b, b + 1});
      beams.area.push_back(h), beams.length.push_back(1);
      beams.inertia_y.push_back(h * h * h / 12), beams.inertia_z.push_back(h / 12);
      beams.torsion.push_back(h * h * h / 4);
      beams.young.push_back(young), beams.shear_modulus.push_back(young / 2.6);
      beams.shear_factor.push_back(5.0 / 6), beams.axis_y.push_back({0, 1, 0});
      beams.width.push_back(1), beams.height.push_back(h);
    }
    return all;
  }
};

/// Curvature w'' of a free beam on the water in a wave of unit amplitude, as the factor of
/// exp(-i omega t): EI w'''' + (rho g - m omega^2 - i omega c) w = F e^(i k x), w'' = w''' = 0 at
/// both ends.
/// \param drag   c of the vertical motion [N s/m^2]
std::vector<Complex> curvature(const Strip& strip, double k, double drag,
                               const std::vector<double>& places) {
  const double omega = std::sqrt(g * k), draft = strip.h * strip.density / rho;
  const double mass = strip.density * strip.h, ei = strip.stiffness(), half = 0.5 * strip.blocks;
  const Complex i(0, 1);
  const Complex bed = rho * g - mass * omega * omega - i * omega * drag;
  // Pressure at the draft, and the velocity of the water at half of it.
  const Complex load = rho * g * std::exp(-k * draft) - i * omega * drag * std::exp(-k * draft / 2);
  const Complex forced = load / (ei * std::pow(k, 4) + bed);
  const Complex root = std::pow(-bed / ei, 0.25);
  const std::array<Complex, 4> s{root, i * root, -root, -i * root};
  Eigen::Matrix4cd a;
  Eigen::Vector4cd b;
  for (Eigen::Index end = 0; end < 2; ++end) {
    const double x = end == 0 ? -half : half;
    for (Eigen::Index order = 0; order < 2; ++order) {
      const double n = 2.0 + static_cast<double>(order);
      for (Eigen::Index j = 0; j < 4; ++j)
        a(2 * end + order, j) = std::pow(s[static_cast<std::size_t>(j)], n) *
                                std::exp(s[static_cast<std::size_t>(j)] * x);
      b[2 * end + order] = -forced * std::pow(i * k, n) * std::exp(i * k * x);
    }
  }
  const Eigen::Vector4cd c = a.partialPivLu().solve(b);
  std::vector<Complex> all;
  for (const double x : places) {
    Complex sum = forced * (i * k) * (i * k) * std::exp(i * k * x);
    for (Eigen::Index j = 0; j < 4; ++j) {
      const Complex sj = s[static_cast<std::size_t>(j)];
      sum += c[j] * sj * sj * std::exp(sj * x);
    }
    all.push_back(sum);
  }
  return all;
}

Scene in_waves(double length, double height, double ramp) {
  Scene scene;
  scene.forces.gravity = scene.forces.buoyancy = scene.forces.drag = scene.forces.beam = true;
  scene.water_density = scene.drag.density = rho;
  scene.beam.shear = Shear::exact;
  scene.drag.linear = 500;  // half of each block is wet: c = 250
  scene.waves.height = height;
  scene.waves.period = 2 * pi / std::sqrt(g * 2 * pi / length);
  scene.waves.ramp = ramp;
  return scene;
}

std::vector<double> joints(const Strip& strip) {
  std::vector<double> x;
  for (int m = 0; m + 1 < strip.blocks; ++m) x.push_back(m + 1 - 0.5 * strip.blocks);
  return x;
}

TEST(WavesOnAStrip, BendingMoments) {
  const Strip strip;
  for (const double length : {24.0, 60.0}) {
    const double k = 2 * pi / length, omega = std::sqrt(g * k), amplitude = 0.01;
    const std::vector<Complex> theory = curvature(strip, k, 250, joints(strip));
    test::Dynamics run(in_waves(length, 2 * amplitude, 10), strip.lattice());
    const double period = 2 * pi / omega;
    const auto per_period = static_cast<long>(std::ceil(period / 2.5e-4));
    const double dt = period / static_cast<double>(per_period);
    run.set_step(dt);
    run.steps(static_cast<long>(std::ceil(30 / period)) * per_period);
    std::vector<Complex> found(theory.size());
    constexpr int samples = 40;
    for (int n = 0; n < samples; ++n) {
      const long until = (n + 1) * per_period / samples, from = n * per_period / samples;
      run.steps(until - from);
      const double angle = omega * run.state().time;
      for (std::size_t m = 0; m < found.size(); ++m) {
        const double turn = 2 * (rotation(run.state(), m + 1).y - rotation(run.state(), m).y);
        found[m] += -turn * std::polar(2.0 / samples / amplitude, angle);  // w' = -theta_y
      }
    }
    double largest = 0, miss = 0;
    for (std::size_t m = 0; m < theory.size(); ++m) {
      largest = std::max(largest, std::abs(theory[m]));
      miss = std::max(miss, std::abs(found[m] - theory[m]));
    }
    double most = 0;
    for (const Complex& c : found) most = std::max(most, std::abs(c));
    // (k l)^2/12 is 0.6 % for a block in the shorter wave.
    test::verify({"Waves",
                  test::text("bending of a floating strip, wave of %g m, over theory", length),
                  most / largest, 1, 0.01});
    test::verify(
        {"Waves",
         test::text("the same, largest error anywhere in amplitude and phase, %g m", length),
         miss / largest, 0, 0.02});
  }
}

/// The wave grows over 60 s; the first beam begins to fail in the crest in which 6 M/(b h^2)
/// reaches the strength, where theory says how high the wave is. It grows by 3.3 % from crest to
/// trough.
TEST(WavesOnAStrip, BreaksAtTheHeightOfTheory) {
  const Strip strip;
  const double length = 24, k = 2 * pi / length, highest = 0.05, ramp = 60;
  double largest = 0;
  for (const Complex& c : curvature(strip, k, 250, joints(strip)))
    largest = std::max(largest, std::abs(c));
  const double strength = 1e5;
  const double amplitude = strength * strip.h * strip.h / 6 / (strip.stiffness() * largest);
  ASSERT_GT(amplitude, 0.5 * highest);
  ASSERT_LT(amplitude, 0.9 * highest);
  Scene scene = in_waves(length, 2 * highest, ramp);
  scene.forces.fracture = true;
  scene.fracture.tensile_strength = strength;
  scene.fracture.shear_strength = strength;
  scene.fracture.dynamic = true;
  test::Dynamics run(scene, strip.lattice());
  run.set_step(2.5e-4);
  while (run.reported("beams_damaged") + run.reported("beams_broken") == 0 &&
         run.state().time < ramp)
    run.steps(200);
  const double found = highest * run.state().time / ramp;
  test::verify({"Waves", "amplitude at which a strip begins to break, over theory",
                found / amplitude, 1.01, 0.035});
}

}  // namespace
}  // namespace floe
