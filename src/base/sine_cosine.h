/// \file
/// Sine and cosine of one angle, on any scalar.
#pragma once

#include <cmath>

#include "base/simd.h"

namespace floe {

template <class T>
struct SineCosine {
  T sine, cosine;
};

template <class T>
SineCosine<T> sine_cosine(const T& angle) {
  using std::cos;
  using std::sin;
  return {sin(angle), cos(angle)};
}

namespace detail {

/// For |x| <= pi/4, to 1.5 units in the last place: the minimax polynomials of fdlibm (Sun
/// Microsystems 1993, k_sin.c and k_cos.c).
inline SineCosine<Lanes> sine_cosine_in_quadrant(const Lanes& x) {
  const Lanes z = x * x;
  Lanes p = 1.58969099521155010221e-10 * z - 2.50507602534068634195e-08;
  p = p * z + 2.75573137070700676789e-06;
  p = p * z - 1.98412698298579493134e-04;
  p = p * z + 8.33333333332248946124e-03;
  p = p * z - 1.66666666666666324348e-01;
  Lanes q = -1.13596475577881948265e-11 * z + 2.08757232129817482790e-09;
  q = q * z - 2.75573143513906633035e-07;
  q = q * z + 2.48015872894767294178e-05;
  q = q * z - 1.38888888888741095749e-03;
  q = q * z + 4.16666666666666019037e-02;
  return {x + (x * z) * p, 1.0 - (0.5 * z - (z * z) * q)};
}

/// For any angle: subtracts the nearest multiple of pi/2, whose value is split into three numbers
/// of 33 bits (Cody & Waite 1980). Beyond 1e6 rad the products are not exact, and the standard
/// functions are called lane by lane.
[[gnu::noinline, gnu::cold]] inline SineCosine<Lanes> sine_cosine_reduced(const Lanes& angle) {
  constexpr double end = 1e6;
  // Adding and subtracting 1.5 * 2^52 rounds to a whole number.
  constexpr double whole = 6755399441055744.0;
  const Lanes quarters = (angle * 0.63661977236758138243 + whole) - whole;
  Lanes x = angle - quarters * 1.57079632673412561417e+00;
  x = x - quarters * 6.07710050630396597660e-11;
  x = x - quarters * 2.02226624879595063154e-21;
  const SineCosine<Lanes> of_rest = sine_cosine_in_quadrant(x);
  const Lanes quadrant = quarters - 4.0 * ((quarters * 0.25 + whole) - whole);  // -2, -1, 0, 1, 2
  const auto odd = quadrant * quadrant == 1.0, opposite = quadrant * quadrant == 4.0;
  SineCosine<Lanes> f = of_rest;
  where(odd, f.sine) = of_rest.cosine;
  where(odd, f.cosine) = of_rest.sine;
  where(opposite || quadrant == -1.0, f.sine) = -f.sine;
  where(opposite || quadrant == 1.0, f.cosine) = -f.cosine;
  for (std::size_t k = 0; k < lanes; ++k) {
    if (std::abs(angle[k]) <= end) continue;
    f.sine[k] = std::sin(double(angle[k]));
    f.cosine[k] = std::cos(double(angle[k]));
  }
  return f;
}

}  // namespace detail

/// The result of a lane does not depend on the other lanes. Few bodies turn by more than pi/4.
inline SineCosine<Lanes> sine_cosine(const Lanes& angle) {
  constexpr double small = 0.785;  // below pi/4, where the reduction subtracts 0
  if (all_of(angle >= -small && angle <= small)) [[likely]]
    return detail::sine_cosine_in_quadrant(angle);
  return detail::sine_cosine_reduced(angle);
}

}  // namespace floe
