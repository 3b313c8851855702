#include "submersion/waves.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <string>
#include <utility>

#include "base/collectives.h"
#include "floe/base/item.h"
#include "floe/base/petsc.h"

namespace floe {
namespace {

constexpr double tau = 2 * std::numbers::pi;
constexpr double bodies_per_wave = 8;

/// Spectrum of Hasselmann et al. (1973), sigma = .07 below the peak and .09 above, up to a factor.
/// \param x  frequency over the peak's
double jonswap(double x, double gamma) {
  const double sigma = x <= 1 ? 0.07 : 0.09;
  const double r = std::exp(-(x - 1) * (x - 1) / (2 * sigma * sigma));
  return std::pow(x, -5) * std::exp(-1.25 * std::pow(x, -4)) * std::pow(gamma, r);
}

WaveComponent component(double amplitude, double omega, double phase, const WaveOptions& options,
                        double gravity) {
  const double k = wave_number(omega, gravity, options.depth);
  return {amplitude, k * std::cos(options.direction), k * std::sin(options.direction), k, omega,
          phase};
}

}  // namespace

double wave_number(double omega, double gravity, double depth) {
  const double deep = omega * omega / gravity;
  if (!(deep * depth < 20)) return deep;  // tanh(20) is 1 to rounding
  double k = deep * depth < 1 ? omega / std::sqrt(gravity * depth) : deep;
  for (int n = 0; n < 50; ++n) {
    const double t = std::tanh(k * depth);
    const double step = (k * t - deep) / (t + k * depth * (1 - t * t));
    k -= step;
    if (std::abs(step) <= 1e-15 * k) break;
  }
  return k;
}

std::vector<WaveComponent> wave_components(const WaveOptions& options, double gravity) {
  const double peak = tau / options.period;
  if (options.spectrum == WaveOptions::Spectrum::regular)
    return {component(options.height / 2, peak, options.phase, options, gravity)};

  // H_s = 4 sqrt(m_0), m_0 = n a^2/2.
  constexpr int cells = 20000;
  constexpr double low = 0.5, high = 3;
  const double width = (high - low) / cells;
  double whole = 0;
  for (int c = 0; c < cells; ++c) whole += jonswap(low + (c + 0.5) * width, options.gamma);
  const int n = options.components;
  const double amplitude = options.height / 4 * std::sqrt(2.0 / n);
  std::mt19937_64 engine(options.seed);
  std::vector<WaveComponent> waves;
  double sum = 0;
  for (int c = 0; c < cells; ++c) {
    sum += jonswap(low + (c + 0.5) * width, options.gamma);
    while (static_cast<int>(waves.size()) < n &&
           sum >= (static_cast<double>(waves.size()) + 0.5) / n * whole) {
      // 53 random bits, the same with every standard library
      const double phase = tau * static_cast<double>(engine() >> 11) * 0x1p-53;
      waves.push_back(
          component(amplitude, (low + (c + 0.5) * width) * peak, phase, options, gravity));
    }
  }
  return waves;
}

Waves::Waves(const Part& part, double gravity, const WaveOptions& options, WaterMotion water)
    : waves_(wave_components(options, gravity)), ramp_(options.ramp), water_(std::move(water)) {
  std::map<double, std::size_t> known;
  double widest = 0;
  const Vec3<double> along{std::cos(options.direction), std::sin(options.direction), 0};
  for (std::size_t b = 0; b < static_cast<std::size_t>(part.owned); ++b) {
    const auto [w, x, y, z] = part.bodies.orientation[b];
    const Triad<double> axes = triad(Quat<double>{w, x, y, z});
    double lowest = 0, back = 0, front = 0;
    for (std::int32_t v = part.shapes.vertex_of[b]; v < part.shapes.vertex_of[b + 1]; ++v) {
      const Vec3<double> r = axes.to_world(item(part.shapes.vertices, v));
      lowest = std::min(lowest, part.bodies.position[b].z + r.z);
      back = std::min(back, dot(along, r)), front = std::max(front, dot(along, r));
    }
    widest = std::max(widest, front - back);
    // Drafts that differ by rounding are one.
    const double draft = std::round(-lowest * 1e9) * 1e-9;
    draft_of_.push_back(known.try_emplace(draft, known.size()).first->second);
  }
  widest = largest_over_ranks(widest, part.comm);
  double shortest = std::numeric_limits<double>::infinity(), slope = 0;
  for (const WaveComponent& wave : waves_) {
    shortest = std::min(shortest, tau / wave.number);
    slope += wave.amplitude * wave.number;
  }
  most_steepness_ = std::sqrt(1 + slope * slope);
  if (shortest < bodies_per_wave * widest) {
    char text[200];
    std::snprintf(text, sizeof text,
                  "waves: period: the shortest wave is %.3g m long; it must be at least 8 bodies "
                  "long, %.3g m: a body feels the surface as a plane",
                  shortest, bodies_per_wave * widest);
    throw InputError(text);
  }
  decay_.resize(known.size() * waves_.size());
  for (const auto& [draft, index] : known) {
    for (std::size_t n = 0; n < waves_.size(); ++n) {
      const double k = waves_[n].number, bottom = 2 * k * options.depth;
      // cosh k(z + H)/cosh kH and so on, without overflow; in deep water all are exp(k z).
      const double at_draft = std::exp(-k * draft), at_half = std::exp(-k * draft / 2);
      const double echo = std::exp(-bottom);
      decay_[index * waves_.size() + n] = {(at_draft + echo / at_draft) / (1 + echo),
                                           (at_half + echo / at_half) / (1 - echo),
                                           (at_half - echo / at_half) / (1 - echo)};
    }
  }
}

SurfacePlane Waves::plane(std::size_t b, const Vec3<double>& at, double time) const {
  const double rise = this->rise(time);
  const Decay* decay = &decay_[first(b)];
  SurfacePlane plane{.level = water_.level(time)};
  for (std::size_t n = 0; n < waves_.size(); ++n) {
    const WaveComponent& wave = waves_[n];
    const double angle = wave.kx * at.x + wave.ky * at.y - wave.omega * time + wave.phase;
    const double a = rise * wave.amplitude * decay[n].pressure, steep = a * std::sin(angle);
    plane.level += a * std::cos(angle);
    plane.slope_x -= wave.kx * steep;
    plane.slope_y -= wave.ky * steep;
  }
  return plane;
}

Vec3<double> Waves::velocity(std::size_t b, const Vec3<double>& at, double time) const {
  const double rise = this->rise(time);
  const Decay* decay = &decay_[first(b)];
  Vec3<double> v = water_.velocity(time);
  for (std::size_t n = 0; n < waves_.size(); ++n) {
    const WaveComponent& wave = waves_[n];
    const double angle = wave.kx * at.x + wave.ky * at.y - wave.omega * time + wave.phase;
    const double speed = rise * wave.amplitude * wave.omega;
    const double along = speed * decay[n].along * std::cos(angle) / wave.number;
    v.x += along * wave.kx;
    v.y += along * wave.ky;
    v.z += speed * decay[n].up * std::sin(angle);
  }
  return v;
}

Waves::Change Waves::change(std::size_t b, const Vec3<double>& at, double time) const {
  const double rise = this->rise(time), rising = ramp_ > 0 && time < ramp_ ? 1 / ramp_ : 0.0;
  const Decay* decay = &decay_[first(b)];
  Change change{};
  change.level = water_.rise(time);
  change.velocity = water_.acceleration(time);
  for (std::size_t n = 0; n < waves_.size(); ++n) {
    const WaveComponent& wave = waves_[n];
    const double angle = wave.kx * at.x + wave.ky * at.y - wave.omega * time + wave.phase;
    const double sine = std::sin(angle), cosine = std::cos(angle);
    const double a = wave.amplitude * decay[n].pressure;
    // Derivatives to the time of rise cos(angle) and of rise sin(angle).
    const double of_cosine = rising * cosine + rise * wave.omega * sine,
                 of_sine = rising * sine - rise * wave.omega * cosine;
    change.level += a * of_cosine;
    change.slope_x -= a * wave.kx * of_sine;
    change.slope_y -= a * wave.ky * of_sine;
    change.xx -= a * rise * cosine * wave.kx * wave.kx;
    change.xy -= a * rise * cosine * wave.kx * wave.ky;
    change.yy -= a * rise * cosine * wave.ky * wave.ky;
    const double speed = wave.amplitude * wave.omega;
    const double along = speed * decay[n].along * of_cosine / wave.number;
    change.velocity.x += along * wave.kx;
    change.velocity.y += along * wave.ky;
    change.velocity.z += speed * decay[n].up * of_sine;
  }
  return change;
}

}  // namespace floe
