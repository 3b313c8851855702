// Lanes as registers hold them, and the transposes between records and lanes.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "base/simd.h"
#include "support/random.h"

namespace floe {
namespace {

using test::Random;

TEST(Lanes, FillARegisterOfTheLevel) {
#if defined(__AVX512F__)
  EXPECT_EQ(lanes, 8U);
#elif defined(__AVX__)
  EXPECT_EQ(lanes, 4U);
#else
  EXPECT_EQ(lanes, 2U);
#endif
  EXPECT_EQ(sizeof(Lanes), lanes * sizeof(double));
  EXPECT_EQ(sizeof(Row), 4 * sizeof(double));
}

/// Records of 11 numbers each, so that few are aligned.
struct Records {
  static constexpr std::size_t count = 20, length = 11;
  std::vector<double> numbers;
  Records() {
    Random random(1);
    for (std::size_t k = 0; k < count * length; ++k) numbers.push_back(random.uniform(-1, 1));
  }
  double* at(std::size_t record) { return numbers.data() + record * length; }
};

TEST(Lanes, GatherAndScatterAreExact) {
  Records records;
  const auto body = [](std::size_t lane) { return (7 * lane + 3) % Records::count; };
  for (std::size_t offset = 0; offset + 4 <= Records::length; ++offset) {
    const std::array<Lanes, 4> four =
        gather_four([&](std::size_t lane) { return records.at(body(lane)) + offset; });
    std::array<Row, lanes> rows;
    scatter_four(four, rows);
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      for (std::size_t k = 0; k < 4; ++k) {
        const double expected = records.at(body(lane))[offset + k];
        EXPECT_EQ(four[k][lane], expected);
        EXPECT_EQ(rows[lane][k], expected);
      }
    }
  }
}

TEST(Lanes, FewLanesTellWhichAreNotAboveZeroAndSum) {
  EXPECT_EQ(few_lanes, lanes < 4 ? lanes : 4U);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::array<double, 8> of{-1, 0, -0.0, 1e-300, nan, -1e-300, 2, -2};
  alignas(64) std::array<double, few_lanes> numbers;
  for (std::size_t k = 0; k < 64; ++k) {
    for (std::size_t lane = 0; lane < few_lanes; ++lane) numbers[lane] = of[(k + lane * k / 8) % 8];
    const std::uint64_t mask = not_above_zero(load_few(numbers.data()));
    for (std::size_t lane = 0; lane < few_lanes; ++lane)
      EXPECT_EQ(mask >> lane & 1, numbers[lane] <= 0 ? 1U : 0U);
    EXPECT_EQ(mask >> few_lanes, 0U);
  }
  const auto counted = [](double times) {
    return FewLanes([&](auto k) { return times * (k + 1); });
  };
  const Row sums = lane_sums(counted(1), counted(10), counted(100), counted(1000));
  const double whole = 0.5 * few_lanes * (few_lanes + 1);
  for (std::size_t k = 0; k < 4; ++k) EXPECT_EQ(sums[k], std::pow(10, k) * whole);
}

TEST(Lanes, RowsAddToMemoryNumberByNumber) {
  Records records;
  const std::vector<double> before = records.numbers;
  const Row row = load_row(records.at(3) + 1);
  add_row(records.at(5) + 2, row);
  for (std::size_t k = 0; k < before.size(); ++k) {
    const std::size_t first = 5 * Records::length + 2, given = 3 * Records::length + 1;
    const bool in_row = k >= first && k < first + 4;
    EXPECT_EQ(records.numbers[k], before[k] + (in_row ? before[given + k - first] : 0.0)) << k;
  }
}

TEST(Lanes, ArithmeticOfRowsIsThatOfNumbers) {
  Records records;
  const double *p = records.at(0), *q = records.at(9);
  const Row a = load_row(p), b = load_row(q);
  const Row sum = a + b, product = a * b, scaled = 0.3 * a, pairs = pair_sums(a),
            most = larger(a, b);
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_EQ(sum[k], p[k] + q[k]);
    EXPECT_EQ(product[k], p[k] * q[k]);
    EXPECT_EQ(scaled[k], 0.3 * p[k]);
    EXPECT_EQ(pairs[k], p[k] + p[k ^ 1U]);
    EXPECT_EQ(most[k], std::max(p[k], q[k]));
  }
}

TEST(Lanes, SignOfZeroIsPlus) {
  for (const double x : {-2.0, -0.0, 0.0, 3.0}) {
    const Lanes sign = sign_of(Lanes(x));
    for (std::size_t lane = 0; lane < lanes; ++lane) EXPECT_EQ(sign[lane], sign_of(x));
  }
}

}  // namespace
}  // namespace floe
