/// \file
/// Choices that do not branch, on any scalar: text for lanes of a processor and for devices, whose
/// compilers do not take lanes.
#pragma once

#include <array>
#include <bit>
#include <cstddef>

#include "base/scalar.h"
#include "floe/base/rotation.h"
#if !defined(__CUDACC__)
#include "base/simd.h"
#endif

namespace floe {

template <class Mask, class T>
constexpr Vec3<T> chosen(const Mask& mask, const Vec3<T>& a, const Vec3<T>& b) {
  return {chosen(mask, a.x, b.x), chosen(mask, a.y, b.y), chosen(mask, a.z, b.z)};
}

/// Return the smaller (larger) one, as std::min and std::max do: a if neither is.
template <class T>
constexpr T smaller_of(const T& a, const T& b) {
  return chosen(b < a, b, a);
}
template <class T>
constexpr T larger_of(const T& a, const T& b) {
  return chosen(a < b, b, a);
}

/// Returns struct a, of one or more numbers of one type T, where the mask is true, else b.
template <template <class> class Struct, class T>
constexpr Struct<T> chosen_of(const MaskOf<T>& mask, const Struct<T>& a, const Struct<T>& b) {
  using Members = std::array<T, sizeof(Struct<T>) / sizeof(T)>;
  const auto from = std::bit_cast<Members>(a);
  auto to = std::bit_cast<Members>(b);
  for (std::size_t k = 0; k < to.size(); ++k) to[k] = chosen(mask, from[k], to[k]);
  return std::bit_cast<Struct<T>>(to);
}

}  // namespace floe
