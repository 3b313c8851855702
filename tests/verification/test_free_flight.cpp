// Leapfrog in free motion: order, and what a top and a flying bar keep over a million steps
// (model.md, "Explicit dynamics").
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "stability/stable_step.h"
#include "support/flying_bar.h"
#include "support/record.h"

namespace floe::test {
namespace {

constexpr const char* section_name = "Explicit dynamics";

TEST(Leapfrog, IsOfOrderTwoAtLargeRotations) {
  const Scene scene = beams_only(Shear::exact);
  const Lattice lattice = flying_bar(6, 25);
  const double end = 1.0;
  const auto at_end = [&](int steps) {
    Dynamics run(scene, lattice);
    run.set_step(end / steps);
    run.steps(steps);
    std::vector<double> all;
    for (std::size_t b = 0; b < 7; ++b) {
      const double* r = run.state().record(b);
      all.insert(all.end(), r, r + 7);
    }
    return all;
  };
  Dynamics first(scene, lattice);
  const double stable = stable_step(first.model(), first.state()).dt;
  const int coarse = static_cast<int>(std::ceil(end / (0.05 * stable)));
  const std::vector<double> fine = at_end(coarse * 64);
  std::array<double, 4> errors{};
  double turn = 0, bend = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    const std::vector<double> got = at_end(coarse << k);
    for (std::size_t i = 0; i < got.size(); ++i)
      errors[k] = std::max(errors[k], std::abs(got[i] - fine[i]));
  }
  const auto q = [&](std::size_t b) {
    const double* r = fine.data() + 7 * b + 3;
    return Quat<double>{r[0], r[1], r[2], r[3]};
  };
  const auto angle = [](const Quat<double>& a) {
    const Vec3<double> t = log_rotation(a);
    return std::sqrt(dot(t, t));
  };
  turn = angle(q(3));
  bend = angle(product(conjugate(q(0)), q(6)));
  for (std::size_t k = 0; k + 1 < 4; ++k) {
    verify(
        {.section = section_name,
         .quantity = text("leapfrog: order from %d and %d steps", coarse << k, coarse << (k + 1)),
         .value = std::log2(errors[k] / errors[k + 1]),
         .reference = 2.0,
         .tolerance = 0.1,
         .note = text("flying bar, 6 beams, turned by %.2f rad, end against end %.2f rad", turn,
                      bend)});
  }
}

TEST(FreeTop, EnergyStaysOverAMillionSteps) {
  Lattice top;
  top.bodies.position = {{0.3, 0.1, -0.2}};
  top.bodies.orientation = {{0.5, 0.5, -0.5, 0.5}};
  top.bodies.mass = {2};
  top.bodies.inertia = {{1, 2, 2.9}};
  top.bodies.velocity = {{0, 0, 0}};
  const Vec3<double> w{0.35, 0.9, 0.25};  // tumbles: near no principal axis
  top.bodies.angular_velocity = {w};
  Dynamics run(Scene{}, top);
  run.set_step(0.006 / std::sqrt(dot(w, w)));
  const double energy = run.kinetic();
  const std::array<double, 6> before = run.momentum();
  constexpr int blocks = 100;
  constexpr long steps = 1000000;
  double largest = 0, first = 0, last = 0;
  for (int block = 0; block < blocks; ++block) {
    double mean = 0;
    constexpr long samples = 500;
    for (long n = 0; n < samples; ++n) {
      run.steps(steps / blocks / samples);
      const double error = run.kinetic() / energy - 1;
      largest = std::max(largest, std::abs(error));
      mean += error / samples;
    }
    if (block < blocks / 10) first += mean / (blocks / 10.0);
    if (block >= blocks - blocks / 10) last += mean / (blocks / 10.0);
  }
  const std::array<double, 6> after = run.momentum();
  const std::string note = "1e6 steps, |omega| dt = 0.006, moments 1, 2, 2.9";
  verify({.section = section_name,
          .quantity = "free top: largest relative error of the energy",
          .value = largest,
          .reference = 0.0,
          .tolerance = 1e-6,
          .note = note});
  verify({.section = section_name,
          .quantity = "free top: mean error in the last tenth less that in the first",
          .value = last - first,
          .reference = 0.0,
          .tolerance = 2e-8,
          .note = "no trend"});
  double change = 0;
  for (std::size_t k = 3; k < 6; ++k) change = std::max(change, std::abs(after[k] - before[k]));
  verify({.section = section_name,
          .quantity = "free top: change of the angular momentum",
          .value = change,
          .reference = 0.0,
          .tolerance = 0.0,
          .unit = "kg m^2/s",
          .note = "kept to the last bit"});
}

/// What is lost of energy and momenta, over their sizes.
TEST(FreeFlight, KeepsEnergyAndMomenta) {
  const Scene scene = beams_only(Shear::exact);
  const Lattice lattice = flying_bar(10, 12);
  Dynamics run(scene, lattice);
  const double stable = stable_step(run.model(), run.state()).dt;
  run.set_step(0.01 * stable);
  const long steps = full_form() ? 1000000 : 100000;
  const double energy = run.kinetic() + run.reported("energy_strain");
  const std::array<double, 6> before = run.momentum();
  const auto size = [](const std::array<double, 6>& p, std::size_t at) {
    return std::hypot(p[at], p[at + 1], p[at + 2]);
  };
  double largest = 0, linear = 0, angular = 0, first = 0, last = 0, strain = 0;
  constexpr int samples = 1000;
  for (int n = 0; n < samples; ++n) {
    run.steps(steps / samples);
    const double stored = run.reported("energy_strain");
    const double error = (run.kinetic() + stored) / energy - 1;
    strain = std::max(strain, stored / energy);
    largest = std::max(largest, std::abs(error));
    if (n < samples / 5) first += error / (samples / 5.0);
    if (n >= samples - samples / 5) last += error / (samples / 5.0);
    std::array<double, 6> change = run.momentum();
    for (std::size_t k = 0; k < 6; ++k) change[k] -= before[k];
    linear = std::max(linear, size(change, 0) / size(before, 0));
    angular = std::max(angular, size(change, 3) / size(before, 3));
  }
  const std::string note = text(
      "flying bar, 10 beams, %ld steps of 0.01 stable_dt; up to %.0f %% of the energy is "
      "strain energy",
      steps, 100 * strain);
  const auto expect = [&](const char* quantity, double value, double tolerance) {
    verify({.section = section_name,
            .quantity = std::string("free flight: ") + quantity,
            .value = value,
            .reference = 0.0,
            .tolerance = tolerance,
            .note = note});
  };
  expect("largest relative error of the energy", largest, 1e-6);
  expect("mean error of the energy, last fifth less first", last - first, 2e-7);
  expect("largest change of the linear momentum, relative", linear, 1e-12);
  expect("largest change of the angular momentum, relative", angular, 1e-9);
}

}  // namespace
}  // namespace floe::test
