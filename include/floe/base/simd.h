/// \file
/// Lanes of doubles: as many as the machine's registers hold, and the transposes between records of
/// bodies and lanes.
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <experimental/simd>

namespace floe {

/// One double per lane (8 with AVX-512, 4 with AVX2, 2 with SSE2).
using Lanes = std::experimental::native_simd<double>;
inline constexpr std::size_t lanes = Lanes::size();

inline Lanes load(const double* aligned) { return {aligned, std::experimental::vector_aligned}; }

/// 1 or -1 with the sign of x.
inline Lanes sign_of(const Lanes& x) {
  Lanes one(1.0);
  where(x < 0.0, one) = -1.0;
  return one;
}
template <class T>
double sign_of(const T& x) {
  return x < 0.0 ? -1.0 : 1.0;
}

/// Asks for all cache lines of something that is read soon.
template <class T>
void prefetch(const T& what) {
  constexpr std::size_t line = 64;
  for (std::size_t k = 0; k < sizeof(T); k += line)
    __builtin_prefetch(reinterpret_cast<const char*>(&what) + k);
}

namespace detail {

using Four [[gnu::vector_size(32)]] = double;

inline Four load_four(const double* p) {
  Four v;
  __builtin_memcpy(&v, p, sizeof v);
  return v;
}

using Eight [[gnu::vector_size(64)]] = double;

/// Entries 0, 2, 4, 6 of a and b in turn; entries 1, 3, 5, 7.
inline Eight evens(Eight a, Eight b) {
  return __builtin_shufflevector(a, b, 0, 8, 2, 10, 4, 12, 6, 14);
}
inline Eight odds(Eight a, Eight b) {
  return __builtin_shufflevector(a, b, 1, 9, 3, 11, 5, 13, 7, 15);
}

/// Rows a, b, c, d to columns, in place.
inline void transpose(Four& a, Four& b, Four& c, Four& d) {
  const Four ab_low = __builtin_shufflevector(a, b, 0, 4, 2, 6),
             ab_high = __builtin_shufflevector(a, b, 1, 5, 3, 7);
  const Four cd_low = __builtin_shufflevector(c, d, 0, 4, 2, 6),
             cd_high = __builtin_shufflevector(c, d, 1, 5, 3, 7);
  a = __builtin_shufflevector(ab_low, cd_low, 0, 1, 4, 5);
  b = __builtin_shufflevector(ab_high, cd_high, 0, 1, 4, 5);
  c = __builtin_shufflevector(ab_low, cd_low, 2, 3, 6, 7);
  d = __builtin_shufflevector(ab_high, cd_high, 2, 3, 6, 7);
}

}  // namespace detail

/// Four consecutive doubles of each of `lanes` records, one record per lane.
/// \param at  where lane k's four doubles stand
template <class At, class Lane = Lanes>  // a parameter, so that only the branch taken is compiled
std::array<Lane, 4> gather_four(At at) {
  using namespace detail;
  constexpr std::size_t width = Lane::size();
  if constexpr (width == 8) {
    // Pairs of records side by side, chosen so that lanes come out in order.
    const auto pair = [&](std::size_t low, std::size_t high) {
      return __builtin_shufflevector(load_four(at(low)), load_four(at(high)), 0, 1, 2, 3, 4, 5, 6,
                                     7);
    };
    const Eight a = pair(0, 2), b = pair(1, 3), c = pair(4, 6), d = pair(5, 7);
    const Eight ab_even = evens(a, b), ab_odd = odds(a, b), cd_even = evens(c, d),
                cd_odd = odds(c, d);
    const auto low = [](Eight x, Eight y) {
      return std::bit_cast<Lane>(__builtin_shufflevector(x, y, 0, 1, 4, 5, 8, 9, 12, 13));
    };
    const auto high = [](Eight x, Eight y) {
      return std::bit_cast<Lane>(__builtin_shufflevector(x, y, 2, 3, 6, 7, 10, 11, 14, 15));
    };
    return {low(ab_even, cd_even), low(ab_odd, cd_odd), high(ab_even, cd_even),
            high(ab_odd, cd_odd)};
  } else if constexpr (width == 4) {
    Four a = load_four(at(0)), b = load_four(at(1)), c = load_four(at(2)), d = load_four(at(3));
    transpose(a, b, c, d);
    return {std::bit_cast<Lane>(a), std::bit_cast<Lane>(b), std::bit_cast<Lane>(c),
            std::bit_cast<Lane>(d)};
  } else {
    std::array<Lane, 4> out;
    for (std::size_t k = 0; k < 4; ++k) out[k] = Lane([&](auto lane) { return at(lane)[k]; });
    return out;
  }
}

/// The way back: four doubles per lane, row by row. \param rows  lanes x 4, filled
template <class Lane>
void scatter_four(const std::array<Lane, 4>& in, std::array<detail::Four, Lane::size()>& rows) {
  using namespace detail;
  constexpr std::size_t width = Lane::size();
  if constexpr (width == 8) {
    const auto eight = [&](std::size_t k) { return std::bit_cast<Eight>(in[k]); };
    const Eight even01 = evens(eight(0), eight(1)), odd01 = odds(eight(0), eight(1)),
                even23 = evens(eight(2), eight(3)), odd23 = odds(eight(2), eight(3));
    const auto put = [&](std::size_t first, Eight x, Eight y) {  // lanes first, + 2, + 4, + 6
      const Eight low = __builtin_shufflevector(x, y, 0, 1, 8, 9, 2, 3, 10, 11),
                  high = __builtin_shufflevector(x, y, 4, 5, 12, 13, 6, 7, 14, 15);
      rows[first] = __builtin_shufflevector(low, low, 0, 1, 2, 3);
      rows[first + 2] = __builtin_shufflevector(low, low, 4, 5, 6, 7);
      rows[first + 4] = __builtin_shufflevector(high, high, 0, 1, 2, 3);
      rows[first + 6] = __builtin_shufflevector(high, high, 4, 5, 6, 7);
    };
    put(0, even01, even23);
    put(1, odd01, odd23);
  } else if constexpr (width == 4) {
    for (std::size_t k = 0; k < 4; ++k) rows[k] = std::bit_cast<Four>(in[k]);
    transpose(rows[0], rows[1], rows[2], rows[3]);
  } else {
    for (std::size_t lane = 0; lane < width; ++lane) {
      for (std::size_t k = 0; k < 4; ++k) rows[lane][k] = in[k][lane];
    }
  }
}

/// Adds four doubles to memory.
inline void add_four(double* p, detail::Four v) {
  v += detail::load_four(p);
  __builtin_memcpy(p, &v, sizeof v);
}

}  // namespace floe
