/// \file
/// Lanes of doubles: one vector register of the processor for which the code is compiled, and the
/// transposes between body records and lanes. No type here is wider than that register: a wider
/// type would be passed through memory, and differently at different levels.
///
/// No public header includes this file, because programs compiled for another level must see the
/// same types.
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <experimental/simd>
#include <type_traits>
#include <utility>
#if defined(__SSE2__)
#include <immintrin.h>
#endif

#include "base/scalar.h"
#include "floe/base/rotation.h"

/// Attributes of a function of which there must be one copy: contraction to fused operations may
/// differ between two copies of a loop.
#if defined(__clang__)
#define FLOE_ONE_COPY gnu::noinline
#else
#define FLOE_ONE_COPY gnu::noinline, gnu::noclone
#endif

namespace floe {

#if defined(__AVX512F__)
inline constexpr std::size_t lanes = 8;
#elif defined(__AVX__)
inline constexpr std::size_t lanes = 4;
#else  // SSE2, NEON
inline constexpr std::size_t lanes = 2;
#endif

/// One double per lane.
using Lanes = std::experimental::simd<double, std::experimental::simd_abi::deduce_t<double, lanes>>;
static_assert(sizeof(Lanes) == lanes * sizeof(double), "a register holds all lanes");

inline Lanes load(const double* aligned) { return {aligned, std::experimental::vector_aligned}; }

/// One double per lane, for short loops, which waste the wider registers: four lanes at most.
inline constexpr std::size_t few_lanes = lanes < 4 ? lanes : 4;
using FewLanes =
    std::experimental::simd<double, std::experimental::simd_abi::deduce_t<double, few_lanes>>;

inline FewLanes load_few(const double* aligned) {
  return {aligned, std::experimental::vector_aligned};
}

/// Returns a mask: bit k is 1 where lane k of x is not above 0.
inline std::uint64_t not_above_zero(const FewLanes& x) {
#if defined(__AVX__)
  const __m256d at_most = _mm256_cmp_pd(std::bit_cast<__m256d>(x), _mm256_setzero_pd(), _CMP_LE_OQ);
  return static_cast<std::uint64_t>(_mm256_movemask_pd(at_most));
#elif defined(__SSE2__)
  const __m128d at_most = _mm_cmple_pd(std::bit_cast<__m128d>(x), _mm_setzero_pd());
  return static_cast<std::uint64_t>(_mm_movemask_pd(at_most));
#else
  std::uint64_t mask = 0;
  for (std::size_t k = 0; k < few_lanes; ++k) mask |= std::uint64_t{x[k] <= 0 ? 1U : 0U} << k;
  return mask;
#endif
}

/// Returns 1 or -1 with the sign of x.
inline Lanes sign_of(const Lanes& x) {
  Lanes one(1.0);
  where(x < 0.0, one) = -1.0;
  return one;
}
template <class T>
double sign_of(const T& x) {
  return x < 0.0 ? -1.0 : 1.0;
}

/// Returns a where the mask is true, else b.
inline Lanes chosen(const Lanes::mask_type& mask, const Lanes& a, Lanes b) {
  where(mask, b) = a;
  return b;
}
using std::experimental::none_of;

/// Calls a function of doubles lane by lane.
template <class Function>
Lanes by_lane(Function function, const Lanes& a, const Lanes& b) {
  return Lanes([&](auto k) { return function(double{a[k]}, double{b[k]}); });
}

/// Returns a mask of bits from one of lanes.
inline std::uint32_t bits_of(const Lanes::mask_type& mask) {
  std::uint32_t bits = 0;
  if (std::experimental::none_of(mask)) return bits;
  for (std::size_t k = 0; k < lanes; ++k) bits |= std::uint32_t{mask[k] ? 1U : 0U} << k;
  return bits;
}

/// Prefetches all cache lines of an object that is read soon.
template <class T>
void prefetch(const T& what) {
  constexpr std::size_t line = 64;
  for (std::size_t k = 0; k < sizeof(T); k += line)
    __builtin_prefetch(reinterpret_cast<const char*>(&what) + k);
}

namespace detail {

/// Loads a vector from memory of any alignment.
template <class V>
V load_vector(const double* p) {
  V v;
  __builtin_memcpy(&v, p, sizeof v);
  return v;
}

using Two [[gnu::vector_size(16)]] = double;

/// Return the even (odd) entries of a and b, alternating.
inline Two evens(Two a, Two b) { return __builtin_shufflevector(a, b, 0, 2); }
inline Two odds(Two a, Two b) { return __builtin_shufflevector(a, b, 1, 3); }

#if defined(__AVX__)

using Four [[gnu::vector_size(32)]] = double;

inline Four evens(Four a, Four b) { return __builtin_shufflevector(a, b, 0, 4, 2, 6); }
inline Four odds(Four a, Four b) { return __builtin_shufflevector(a, b, 1, 5, 3, 7); }

#endif
#if defined(__AVX512F__)

using Eight [[gnu::vector_size(64)]] = double;

/// evens: entries 0, 2, 4, 6 of a and b, alternating; odds: entries 1, 3, 5, 7.
inline Eight evens(Eight a, Eight b) {
  return __builtin_shufflevector(a, b, 0, 8, 2, 10, 4, 12, 6, 14);
}
inline Eight odds(Eight a, Eight b) {
  return __builtin_shufflevector(a, b, 1, 9, 3, 11, 5, 13, 7, 15);
}

#endif

}  // namespace detail

/// Four consecutive doubles of a record.
#if defined(__AVX__)
using Row = detail::Four;

inline Row load_row(const double* p) { return detail::load_vector<Row>(p); }
inline void store_row(double* p, const Row& row) { __builtin_memcpy(p, &row, sizeof row); }
/// Returns the sum of entries 0 and 1 in places 0 and 1, that of entries 2 and 3 in places 2 and 3.
inline Row pair_sums(const Row& r) { return r + __builtin_shufflevector(r, r, 1, 0, 3, 2); }
inline Row larger(const Row& a, const Row& b) { return a > b ? a : b; }
#else
struct Row {
  detail::Two low, high;
  double operator[](std::size_t k) const { return k < 2 ? low[k] : high[k - 2]; }
};

inline Row load_row(const double* p) {
  return {detail::load_vector<detail::Two>(p), detail::load_vector<detail::Two>(p + 2)};
}
inline void store_row(double* p, const Row& row) { __builtin_memcpy(p, &row, sizeof row); }
inline Row operator+(const Row& a, const Row& b) { return {a.low + b.low, a.high + b.high}; }
inline Row operator-(const Row& a, const Row& b) { return {a.low - b.low, a.high - b.high}; }
inline Row operator*(const Row& a, const Row& b) { return {a.low * b.low, a.high * b.high}; }
inline Row operator*(double s, const Row& a) { return {s * a.low, s * a.high}; }
inline Row pair_sums(const Row& r) {
  return {r.low + __builtin_shufflevector(r.low, r.low, 1, 0),
          r.high + __builtin_shufflevector(r.high, r.high, 1, 0)};
}
inline Row larger(const Row& a, const Row& b) {
  return {a.low > b.low ? a.low : b.low, a.high > b.high ? a.high : b.high};
}
#endif

/// Returns the sums over the lanes of a, b, c and d.
inline Row lane_sums(const FewLanes& a, const FewLanes& b, const FewLanes& c, const FewLanes& d) {
  using namespace detail;
#if defined(__AVX__)
  const auto four = [](const FewLanes& x) { return std::bit_cast<Four>(x); };
  const Four ab = evens(four(a), four(b)) + odds(four(a), four(b)),
             cd = evens(four(c), four(d)) + odds(four(c), four(d));
  return __builtin_shufflevector(ab, cd, 0, 1, 4, 5) + __builtin_shufflevector(ab, cd, 2, 3, 6, 7);
#else
  const auto two = [](const FewLanes& x) { return std::bit_cast<Two>(x); };
  return {evens(two(a), two(b)) + odds(two(a), two(b)),
          evens(two(c), two(d)) + odds(two(c), two(d))};
#endif
}

/// Add four doubles to memory, subtract four, add two, subtract two.
inline void add_row(double* p, const Row& row) { store_row(p, load_row(p) + row); }
inline void subtract_row(double* p, const Row& row) { store_row(p, load_row(p) - row); }
inline void add_pair(double* p, detail::Two pair) {
  pair = detail::load_vector<detail::Two>(p) + pair;
  __builtin_memcpy(p, &pair, sizeof pair);
}
inline void subtract_pair(double* p, detail::Two pair) {
  pair = detail::load_vector<detail::Two>(p) - pair;
  __builtin_memcpy(p, &pair, sizeof pair);
}

/// Returns four consecutive doubles of each of `lanes` records as four vectors, one record per
/// lane.
/// \param at  function from the lane to the address of its four doubles
template <class At>
[[gnu::always_inline]] inline std::array<Lanes, 4> gather_four(At at) {
  using namespace detail;
#if defined(__AVX512F__)
  // Puts pairs of records side by side, so that the lanes come out in order.
  const auto pair = [&](std::size_t low, std::size_t high) __attribute__((always_inline)) {
    return __builtin_shufflevector(load_row(at(low)), load_row(at(high)), 0, 1, 2, 3, 4, 5, 6, 7);
  };
  const Eight a = pair(0, 2), b = pair(1, 3), c = pair(4, 6), d = pair(5, 7);
  const Eight ab_even = evens(a, b), ab_odd = odds(a, b), cd_even = evens(c, d),
              cd_odd = odds(c, d);
  const auto low = [](Eight x, Eight y) {
    return std::bit_cast<Lanes>(__builtin_shufflevector(x, y, 0, 1, 4, 5, 8, 9, 12, 13));
  };
  const auto high = [](Eight x, Eight y) {
    return std::bit_cast<Lanes>(__builtin_shufflevector(x, y, 2, 3, 6, 7, 10, 11, 14, 15));
  };
  return {low(ab_even, cd_even), low(ab_odd, cd_odd), high(ab_even, cd_even), high(ab_odd, cd_odd)};
#elif defined(__AVX__)
  // Halves of records 0 and 2, and of 1 and 3, side by side: the loads build these, so that one
  // shuffle per result is left.
  const auto pair = [&](std::size_t low, std::size_t high, std::size_t half)
      __attribute__((always_inline)) {
    return __builtin_shufflevector(load_vector<Two>(at(low) + half),
                                   load_vector<Two>(at(high) + half), 0, 1, 2, 3);
  };
  const Four a = pair(0, 2, 0), b = pair(1, 3, 0), c = pair(0, 2, 2), d = pair(1, 3, 2);
  return {std::bit_cast<Lanes>(evens(a, b)), std::bit_cast<Lanes>(odds(a, b)),
          std::bit_cast<Lanes>(evens(c, d)), std::bit_cast<Lanes>(odds(c, d))};
#else
  const Row a = load_row(at(0)), b = load_row(at(1));
  return {std::bit_cast<Lanes>(evens(a.low, b.low)), std::bit_cast<Lanes>(odds(a.low, b.low)),
          std::bit_cast<Lanes>(evens(a.high, b.high)), std::bit_cast<Lanes>(odds(a.high, b.high))};
#endif
}

/// Number of the numbers of a struct whose members are all of one type T.
template <template <class> class Struct>
inline constexpr std::size_t numbers_of = sizeof(Struct<double>) / sizeof(double);

/// Returns a struct of lanes, of one struct of doubles per lane: at least four numbers.
/// \param at  function from the lane to the address of its struct
template <template <class> class Struct, class At>
[[gnu::always_inline]] inline Struct<Lanes> gathered(At at) {
  constexpr std::size_t n = numbers_of<Struct>;
  static_assert(n >= 4 && sizeof(Struct<Lanes>) == n * sizeof(Lanes));
  static_assert(std::is_trivially_copyable_v<Struct<Lanes>>);
  Struct<Lanes> all;
  for (std::size_t k = 0; k < n; k += 4) {
    const std::size_t first = k + 4 <= n ? k : n - 4;
    const std::array<Lanes, 4> four = gather_four(
        [&](std::size_t lane) { return reinterpret_cast<const double*>(at(lane)) + first; });
    __builtin_memcpy(reinterpret_cast<char*>(&all) + first * sizeof(Lanes), &four, sizeof four);
  }
  return all;
}

/// Returns the struct of one lane.
template <template <class> class Struct>
Struct<double> one_lane(const Struct<Lanes>& all, std::size_t lane) {
  constexpr std::size_t n = numbers_of<Struct>;
  static_assert(sizeof(Struct<Lanes>) == n * sizeof(Lanes));
  std::array<double, n> numbers;
  const char* const from = reinterpret_cast<const char*>(&all) + lane * sizeof(double);
  for (std::size_t k = 0; k < n; ++k)
    __builtin_memcpy(&numbers[k], from + k * sizeof(Lanes), sizeof(double));
  return std::bit_cast<Struct<double>>(numbers);
}

/// Two numbers per lane side by side, the first step of the transpose from lanes to records: the
/// pair (a, b) of lane k is pair k / 2 of the register `even` or `odd`.
struct Pairs {
  Lanes even, odd;
  Pairs(const Lanes& a, const Lanes& b)
      : even(std::bit_cast<Lanes>(detail::evens(vector(a), vector(b)))),
        odd(std::bit_cast<Lanes>(detail::odds(vector(a), vector(b)))) {}

#if defined(__AVX512F__)
  using Vector = detail::Eight;
#elif defined(__AVX__)
  using Vector = detail::Four;
#else
  using Vector = detail::Two;
#endif
  static Vector vector(const Lanes& x) { return std::bit_cast<Vector>(x); }
  template <std::size_t lane>
  Vector of() const {
    return vector(lane % 2 == 0 ? even : odd);
  }
};

/// Returns the pair of a lane.
template <std::size_t lane>
detail::Two pair_of(const Pairs& p) {
  constexpr int k = lane / 2 * 2;
  return __builtin_shufflevector(p.of<lane>(), p.of<lane>(), k, k + 1);
}

/// Returns the two pairs of a lane as a row.
template <std::size_t lane>
Row row_of(const Pairs& first, const Pairs& second) {
#if defined(__AVX__)
  constexpr int k = lane / 2 * 2, n = lanes;
  return __builtin_shufflevector(first.of<lane>(), second.of<lane>(), k, k + 1, n + k, n + k + 1);
#else
  return {first.of<lane>(), second.of<lane>()};
#endif
}

/// Transposes four vectors of lanes to four doubles per record, and hands them on.
/// \param put  function called with std::integral_constant of the lane and with its row
inline void scatter_four(const std::array<Lanes, 4>& in, auto put) {
  const Pairs first(in[0], in[1]), second(in[2], in[3]);
  [&]<std::size_t... lane>(std::index_sequence<lane...>) {
    (put(std::integral_constant<std::size_t, lane>{}, row_of<lane>(first, second)), ...);
  }
  (std::make_index_sequence<lanes>{});
}
/// The same into an array. \param rows  one row per lane, filled
inline void scatter_four(const std::array<Lanes, 4>& in, std::array<Row, lanes>& rows) {
  using namespace detail;
#if defined(__AVX512F__)
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
#elif defined(__AVX__)
  const auto four = [&](std::size_t k) { return std::bit_cast<Four>(in[k]); };
  const Four even01 = evens(four(0), four(1)), odd01 = odds(four(0), four(1)),
             even23 = evens(four(2), four(3)), odd23 = odds(four(2), four(3));
  rows[0] = __builtin_shufflevector(even01, even23, 0, 1, 4, 5);
  rows[1] = __builtin_shufflevector(odd01, odd23, 0, 1, 4, 5);
  rows[2] = __builtin_shufflevector(even01, even23, 2, 3, 6, 7);
  rows[3] = __builtin_shufflevector(odd01, odd23, 2, 3, 6, 7);
#else
  const auto two = [&](std::size_t k) { return std::bit_cast<Two>(in[k]); };
  rows[0] = {evens(two(0), two(1)), evens(two(2), two(3))};
  rows[1] = {odds(two(0), two(1)), odds(two(2), two(3))};
#endif
}

/// Structs of doubles, one per lane, as rows of n numbers that are filled up to whole rows.
/// \tparam Struct  of 4 k + 2 numbers
template <template <class> class Struct>
class LaneRows {
 public:
  explicit LaneRows(const Struct<Lanes>& all) {
    const auto from = std::bit_cast<std::array<Lanes, n>>(all);
    for (std::size_t k = 0; k < n; k += 4) {
      const std::size_t third = k + 2 < n ? k + 2 : k;
      std::array<Row, lanes> four;
      scatter_four({from[k], from[k + 1], from[third], from[third + 1]}, four);
      for (std::size_t lane = 0; lane < lanes; ++lane) store_row(&rows_[lane][k], four[lane]);
    }
  }

  /// Adds the numbers of a lane.
  void add(std::size_t lane, Struct<double>& to) const {
    double* const p = reinterpret_cast<double*>(&to);
    const double* const row = rows_[lane].data();
    for (std::size_t k = 0; k + 4 <= n; k += 4) add_row(p + k, load_row(row + k));
    add_pair(p + n - 2, detail::load_vector<detail::Two>(row + n - 2));
  }
  /// Subtracts the numbers of a lane.
  void subtract(std::size_t lane, Struct<double>& from) const {
    double* const p = reinterpret_cast<double*>(&from);
    const double* const row = rows_[lane].data();
    for (std::size_t k = 0; k + 4 <= n; k += 4) subtract_row(p + k, load_row(row + k));
    subtract_pair(p + n - 2, detail::load_vector<detail::Two>(row + n - 2));
  }

 private:
  static constexpr std::size_t n = numbers_of<Struct>;
  static_assert(n % 4 == 2);
  alignas(64) std::array<std::array<double, n + 2>, lanes> rows_;
};

}  // namespace floe
