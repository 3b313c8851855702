// Tension of mooring lines: between the rows of a table, beyond them, and its energy.
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "floe/forces/mooring_line.h"

namespace floe {
namespace {

TensionCurve curve() { return TensionCurve({{10, 100}, {12, 300}, {13, 1300}}); }

TEST(MooringLine, TensionIsThatOfItsTable) {
  const TensionCurve t = curve();
  EXPECT_DOUBLE_EQ(t.tension(10), 100);
  EXPECT_DOUBLE_EQ(t.tension(11), 200);
  EXPECT_DOUBLE_EQ(t.tension(12.5), 800);
  EXPECT_DOUBLE_EQ(t.tension(14), 2300);  // as in the last piece
  EXPECT_DOUBLE_EQ(t.tension(9.5), 50);   // as in the first one
  EXPECT_DOUBLE_EQ(t.tension(9), 0);
  EXPECT_DOUBLE_EQ(t.tension(5), 0);
  EXPECT_DOUBLE_EQ(t.slope(12.5), 1000);
  EXPECT_DOUBLE_EQ(t.slope(5), 0);
  EXPECT_DOUBLE_EQ(t.steepest(), 1000);
  EXPECT_DOUBLE_EQ(t.length_at(800), 12.5);
  EXPECT_DOUBLE_EQ(t.length_at(50), 9.5);
}

TEST(MooringLine, EnergyIsTheIntegralOfTheTension) {
  TensionCurve t = curve();
  double sum = 0;
  constexpr double step = 1e-4;
  double length = 8;
  for (int k = 0; k < 70000; ++k) {
    if (k % 5000 == 0) {
      EXPECT_NEAR(t.energy(length), sum, 1e-5 * (1 + sum)) << length;
    }
    sum += 0.5 * step * (t.tension(length) + t.tension(length + step));
    length += step;
  }
  t.lengthen(1);
  EXPECT_DOUBLE_EQ(t.tension(12), 200);
}

TEST(MooringLine, TablesThatFallAreRefused) {
  EXPECT_THROW(TensionCurve({{1, 0}}), std::invalid_argument);
  EXPECT_THROW(TensionCurve({{1, 0}, {1, 1}}), std::invalid_argument);
  EXPECT_THROW(TensionCurve({{1, 2}, {2, 1}}), std::invalid_argument);
}

}  // namespace
}  // namespace floe
