/// \file
/// Roots on a line, by which a step of a path ends where a reading of the state has its value.
#pragma once

#include <cmath>
#include <optional>
#include <utility>

namespace floe {

/// A point of a function.
struct Sounding {
  double at, value;
};

/// Root between a point with value <= 0 and one with value > 0, by the Illinois form of regula
/// falsi (Dowell & Jarratt 1971). \param tolerance  of the function's value
template <class Function>
double bracketed_root(Function&& g, Sounding inside, Sounding outside, double tolerance) {
  constexpr int most = 100;
  double weight_inside = inside.value, weight_outside = outside.value;
  int side = 0;
  for (int k = 0; k < most; ++k) {
    const double at =
        outside.at - weight_outside * (outside.at - inside.at) / (weight_outside - weight_inside);
    const double value = g(at);
    if (std::abs(value) <= tolerance) return at;
    if (value <= 0) {
      inside = {at, value}, weight_inside = value;
      if (side == 1) weight_outside *= 0.5;
      side = 1;
    } else {
      outside = {at, value}, weight_outside = value;
      if (side == -1) weight_inside *= 0.5;
      side = -1;
    }
  }
  return inside.at;
}

/// Far end of the interval in which a convex function is at most 0: the largest t with g(t) = 0.
/// Nothing if g is above 0 everywhere, or at most 0 as far as 1e9 units.
/// \param unit       typical step of t, > 0
/// \param tolerance  of the function's value
template <class Function>
std::optional<double> far_end(Function&& g, double unit, double tolerance) {
  constexpr int doublings = 40;
  constexpr double first = 1e-3;  // units
  Sounding inside{0, g(0)};
  if (inside.value > 0) {  // goes down the slope to a point inside
    const Sounding start = inside;
    double step = -first * unit;
    Sounding next{step, g(step)};
    if (next.value >= start.value) step = -step, next = {step, g(step)};
    Sounding before = start, two_before = start;
    for (int k = 0; next.value > 0; ++k) {
      if (next.value > before.value || k == doublings) break;
      two_before = std::exchange(before, next);
      step *= 2;
      next = {before.at + step, 0};
      next.value = g(next.at);
    }
    if (next.value > 0) {  // the minimum lies between two_before and next
      double low = two_before.at, high = next.at;
      constexpr double golden = 0.6180339887498949;
      for (int k = 0; k < 60 && next.value > 0; ++k) {
        const Sounding a{high - golden * (high - low), g(high - golden * (high - low))},
            b{low + golden * (high - low), g(low + golden * (high - low))};
        next = a.value < b.value ? a : b;
        (a.value < b.value ? high : low) = a.value < b.value ? b.at : a.at;
      }
      if (next.value > 0) return {};
      before = start;
    }
    if (next.at < before.at) return bracketed_root(g, next, before, tolerance);
    inside = next;
  }
  double step = first * unit;
  for (int k = 0; k < doublings; ++k, step *= 2) {
    const Sounding next{inside.at + step, g(inside.at + step)};
    if (next.value > 0) return bracketed_root(g, inside, next, tolerance);
    inside = next;
  }
  return {};
}

/// Root near 0 of a function that is nearly linear there, by secants; nothing if there is none.
/// \param unit       typical step of t
/// \param tolerance  of the function's value
template <class Function>
std::optional<double> near_root(Function&& g, double unit, double tolerance) {
  constexpr int most = 50;
  Sounding last{0, g(0)};
  if (std::abs(last.value) <= tolerance) return 0.0;
  Sounding now{1e-3 * unit, g(1e-3 * unit)};
  for (int k = 0; k < most; ++k) {
    if (std::abs(now.value) <= tolerance) return now.at;
    const double slope = (now.value - last.value) / (now.at - last.at);
    const double at = now.at - now.value / slope;
    if (!std::isfinite(at)) return {};
    last = std::exchange(now, {at, g(at)});
  }
  return {};
}

}  // namespace floe
