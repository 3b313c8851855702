#include "contact_laws/restitution.h"

#include <cmath>

namespace floe {
namespace {

/// Returns e of a damping ratio.
double restitution_of(double zeta) {
  const double s = 1 - zeta * zeta;
  if (std::abs(s) < 1e-12) return std::exp(-2.0);
  return s > 0 ? std::exp(-2 * zeta * std::acos(zeta) / std::sqrt(s))
               : std::exp(-2 * zeta * std::acosh(zeta) / std::sqrt(-s));
}

}  // namespace

double damping_ratio_of(double restitution) {
  double low = 0, high = 1;
  while (restitution_of(high) > restitution) high *= 2;
  for (int k = 0; k < 100; ++k) {
    const double middle = 0.5 * (low + high);
    (restitution_of(middle) > restitution ? low : high) = middle;
  }
  return restitution >= 1 ? 0.0 : 0.5 * (low + high);
}

}  // namespace floe
