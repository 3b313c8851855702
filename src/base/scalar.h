/// \file
/// Choices on one double. Those on lanes are in base/simd.h; text for both takes base/choices.h.
#pragma once

namespace floe {

/// Answers of a comparison: one bool, or one per lane.
template <class T>
using MaskOf = decltype(T{} < T{});

/// Returns a where the mask is true, else b.
constexpr double chosen(bool mask, double a, double b) { return mask ? a : b; }
/// Whether no answer is true.
constexpr bool none_of(bool mask) { return !mask; }

/// Calls a function of doubles lane by lane.
template <class Function>
constexpr double by_lane(Function function, double a, double b) {
  return function(a, b);
}

}  // namespace floe
