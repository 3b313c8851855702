#include "stability/rk_stability.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace floe {
namespace {

using Complex = std::complex<double>;
constexpr double infinity = std::numeric_limits<double>::infinity();

/// A pair (c, k), each relative to its largest value.
struct Pair {
  double c, k;
};
Pair operator-(const Pair& a, const Pair& b) { return {a.c - b.c, a.k - b.k}; }
double dot(const Pair& a, const Pair& b) { return a.c * b.c + a.k * b.k; }
double cross(const Pair& a, const Pair& b) { return a.c * b.k - a.k * b.c; }
Pair between(const Pair& a, const Pair& b, double t) {
  return {a.c + t * (b.c - a.c), a.k + t * (b.k - a.k)};
}

using Polygon = std::vector<Pair>;  // convex, counter-clockwise

/// Clips a polygon to the half-plane n.p <= s (Sutherland and Hodgman 1974).
Polygon clipped(const Polygon& polygon, const Pair& n, double s) {
  Polygon kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Pair &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    const double at = dot(n, a) - s, bt = dot(n, b) - s;
    if (at <= 0) kept.push_back(a);
    if ((at < 0 && bt > 0) || (at > 0 && bt < 0)) kept.push_back(between(a, b, at / (at - bt)));
  }
  return kept;
}

/// Convex hull, counter-clockwise (Andrew 1979).
Polygon hull(Polygon points) {
  std::sort(points.begin(), points.end(),
            [](const Pair& a, const Pair& b) { return a.c < b.c || (a.c == b.c && a.k < b.k); });
  Polygon ring;
  for (int pass = 0; pass < 2; ++pass) {
    const std::size_t base = ring.size();
    for (const Pair& p : points) {
      while (ring.size() >= base + 2 &&
             cross(ring.back() - ring[ring.size() - 2], p - ring[ring.size() - 2]) <= 0)
        ring.pop_back();
      ring.push_back(p);
    }
    ring.pop_back();
    std::reverse(points.begin(), points.end());
  }
  return ring;
}

/// Returns the point of a polygon's boundary nearest to p.
Pair nearest(const Polygon& polygon, const Pair& p) {
  Pair best{};
  double least = infinity;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Pair &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    const Pair along = b - a;
    const double length2 = dot(along, along);
    const double t = length2 > 0 ? std::clamp(dot(p - a, along) / length2, 0.0, 1.0) : 0.0;
    const Pair q = between(a, b, t);
    const double distance2 = dot(p - q, p - q);
    if (distance2 < least) {
      least = distance2;
      best = q;
    }
  }
  return best;
}

/// The point of the boundary with the least stable step. As dt grows from 0, the boundary of the
/// set (c dt, k dt^2) of all pairs is the first part to reach unstable pairs.
struct Worst {
  double dt = infinity;
  Pair at{};
};

}  // namespace

StabilityPolynomial::StabilityPolynomial(std::span<const double> a, std::span<const double> b) {
  const std::size_t s = b.size();
  std::vector<double> power(s, 1.0), next(s);  // A^j times ones
  coefficients_.push_back(1);
  for (std::size_t j = 0; j < s; ++j) {
    double sum = 0;
    for (std::size_t i = 0; i < s; ++i) sum += b[i] * power[i];
    coefficients_.push_back(sum);
    for (std::size_t i = 0; i < s; ++i) {
      next[i] = 0;
      for (std::size_t k = 0; k < i; ++k) next[i] += a[i * s + k] * power[k];
    }
    power.swap(next);
  }
}

Complex StabilityPolynomial::operator()(Complex z) const {
  Complex sum = 0;
  for (std::size_t j = coefficients_.size(); j-- > 0;) sum = sum * z + coefficients_[j];
  return sum;
}

double StabilityPolynomial::largest_step(double stiffness, double damping, double growth) const {
  // In units of `size` the roots have absolute values of at most 2.
  const double size = std::max(damping, std::sqrt(stiffness));
  if (!(size > 0)) return infinity;
  const double half = 0.5 * damping / size, k = stiffness / size / size;
  const Complex root = std::sqrt(Complex(half * half - k));
  const std::array<Complex, 2> roots{-half + root, -half - root};
  const double most = (1 + growth) * (1 + growth);
  const auto grows = [&](Complex z) { return !(std::norm((*this)(z)) <= most); };
  const auto unstable = [&](double t) { return grows(t * roots[0]) || grows(t * roots[1]); };
  // The stability region of no method extends further than the square of its number of stages.
  const auto stages = static_cast<double>(coefficients_.size() - 1);
  double low = 0, high = 1e-4;
  for (constexpr double stride = 0.02; !unstable(high); high += stride) {
    low = high;
    if (high > 2 * stages * stages + 1) return infinity;
  }
  for (int it = 0; it < 50; ++it) {
    const double middle = 0.5 * (low + high);
    (unstable(middle) ? high : low) = middle;
  }
  return low / size;
}

namespace {

Worst worst(const StabilityPolynomial& polynomial, const Polygon& polygon, const Pair& scale,
            double growth) {
  constexpr int per_edge = 32;
  Worst found;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    for (int n = 0; n < per_edge; ++n) {
      const Pair p = between(polygon[i], polygon[(i + 1) % polygon.size()], n / double(per_edge));
      const double dt = polynomial.largest_step(std::max(0.0, p.k) * scale.k,
                                                std::max(0.0, p.c) * scale.c, growth);
      if (dt < found.dt) found = {dt, p};
    }
  }
  return found;
}

}  // namespace

StableStep rk_stable_step(const StabilityPolynomial& polynomial, const Model<Spatial>& model,
                          const State<Spatial>& state, double growth) {
  std::vector<VibrationMode> modes;
  StableStep result;
  const auto search = [&](const Weights& weights) -> const VibrationMode& {
    modes.push_back(extreme_mode(model, state, weights, modes.empty() ? nullptr : &modes.back()));
    result.evaluations += modes.back().evaluations;
    return modes.back();
  };
  // Eigenvalues are found to 1e-6; the margin keeps the polygon outside in spite of that.
  constexpr double margin = 1e-5;
  Pair scale{};
  scale.k = std::max(0.0, search({1, 0}).value);
  scale.c = std::max(0.0, search({0, 1}).value);
  const bool damped = scale.c > 1e-9 * std::sqrt(scale.k);
  if (!damped) scale.c = 0;
  const auto pair_of = [&](const VibrationMode& m) {
    return Pair{damped ? std::max(0.0, m.damping) / scale.c : 0.0,
                scale.k > 0 ? std::max(0.0, m.stiffness) / scale.k : 0.0};
  };
  const double top = 1 + margin, right = damped ? top : 0;
  Polygon outer{{0, 0}, {right, 0}, {right, top}, {0, top}};
  Polygon inner{{0, 0}, pair_of(modes[0]), pair_of(modes[1])};
  Worst limit = worst(polynomial, outer, scale, growth);
  constexpr int most = 8;
  constexpr double close = 0.99;
  for (int it = 0; damped && scale.k > 0 && it < most; ++it) {
    const Polygon reached = hull(inner);
    if (limit.dt >= close * worst(polynomial, reached, scale, growth).dt) break;
    // The line separates the limiting point from the hull of the pairs found.
    Pair n = limit.at - nearest(reached, limit.at);
    const double length = std::sqrt(dot(n, n));
    if (length < margin) break;
    n = {n.c / length, n.k / length};
    const VibrationMode& mode = search({n.k / scale.k, n.c / scale.c});
    outer = clipped(outer, n, mode.value + margin);
    inner.push_back(pair_of(mode));
    limit = worst(polynomial, outer, scale, growth);
  }
  result.dt = limit.dt;
  result.omega = std::sqrt(std::max(0.0, limit.at.k) * scale.k);
  result.decay = std::max(0.0, limit.at.c) * scale.c;
  // Report the mode whose pair is nearest to the limiting point.
  double least = infinity;
  for (const VibrationMode& mode : modes) {
    const Pair apart = pair_of(mode) - limit.at;
    if (dot(apart, apart) >= least) continue;
    least = dot(apart, apart);
    result.limit = mode.where;
  }
  return result;
}

}  // namespace floe
