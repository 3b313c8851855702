#include "floe/lattice/material.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace floe {

double saint_venant_torsion(double a, double b) {
  if (a < b) std::swap(a, b);
  if (!(b > 0)) return 0;
  constexpr double pi = std::numbers::pi;
  // tanh(x) = 1 - 2/(exp(2x) + 1) splits the series into a known sum, (31/32) zeta(5) over the odd
  // n, and a rest that falls like exp(-n pi a/b): seven terms instead of over a thousand.
  constexpr double zeta5 = 1.0369277551433699263;
  const double ratio = a / b;
  double sum = 31.0 / 32 * zeta5;
  for (int n = 1; n <= 13; n += 2) {
    const double decay = std::exp(-n * pi * ratio);
    if (decay < 1e-18) break;
    const double n2 = n * n;
    sum -= 2 * decay / ((1 + decay) * n2 * n2 * n);
  }
  return a * b * b * b * (1.0 / 3 - 64 / (pi * pi * pi * pi * pi * ratio) * sum);
}

}  // namespace floe
