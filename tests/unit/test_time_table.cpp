// Values by tables in time, against scipy (1.10) and by hand.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "floe/base/time_table.h"

namespace floe {
namespace {

using Rows = std::vector<std::vector<double>>;
using enum TimeTable::Interpolation;

/// A time, and there the value, its first two derivatives and its integral from 0.
using Expected = std::array<double, 5>;

void expect_all(const TimeTable& table, std::size_t column, const std::vector<Expected>& all) {
  for (const auto& [time, value, rate, second, integral] : all) {
    EXPECT_NEAR(table.value(column, time), value, 1e-14) << time;
    EXPECT_NEAR(table.rate(column, time), rate, 1e-13) << time;
    EXPECT_NEAR(table.second(column, time), second, 1e-11) << time;
    EXPECT_NEAR(table.integral(column, time), integral, 1e-13) << time;
  }
}

const Rows uneven{{-1, 2}, {0.5, 2.5}, {1, 2.5}, {2.5, -1}, {3, -1.25}, {4.5, 4}, {5, 3}};

/// scipy.interpolate.PchipInterpolator.
TEST(TimeTable, SmoothIsThatOfScipy) {
  expect_all(
      TimeTable(uneven, smooth, false), 0,
      {{-1, 2, 0.58333333333333326, -0.2222222222222221, -2.2453703703703702},
       {-0.4, 2.302, 0.41, -0.35555555555555551, -0.9495703703703704},
       {0.2, 2.476, 0.15666666666666668, -0.48888888888888893, 0.49142962962962944},
       {0.5, 2.5, 0, 0, 1.2390046296296298},
       {0.8, 2.5, 0, 0, 1.9890046296296298},
       {1, 2.5, 0, -8.3421828908554581, 2.4890046296296298},
       {1.7, 1.0542510652245167, -3.2763028515240906, -1.0186823992133736, 3.866774868895444},
       {2.49, -0.99220056374959142, -0.81635004916420684, 7.2464110127826977, 3.76334677164864},
       {2.75, -1.1714601769911503, -0.56415929203539816, 1.4867256637168142, 3.4810192867092757},
       {3.9, 2.152, 5.04, -2.8, 3.2410984349393637},
       {4.8, 3.595, -2.475, -6, 6.3957109349393635}});
}

/// PchipInterpolator over three periods before and after.
TEST(TimeTable, PeriodicIsSmoothThroughItsEnds) {
  const TimeTable table({{0, 1}, {0.3, 3}, {1, -2}, {1.6, 0.5}, {2, 1}}, smooth, true);
  expect_all(
      table, 0,
      {{-1.9, 1.6152369986566886, 8.8888888888888911, 29.936672423718989, -0.63119719139444164},
       {-0.2, 0.73401349202277744, 0.86684963833170925, 0.79932539886112686, -0.16903696198635404},
       {0, 1, 2.176165803108808, 104.31778929188258, 0},
       {0.1, 1.6152369986566879, 8.8888888888888893, 29.936672423719045, 0.12516791402801766},
       {0.6, 1.032069970845481, -10.495626822157433, -8.7463556851311921, 1.2998489403163189},
       {1.5, 0.18589567290062314, 4.245737073707371, -18.495599559955984, 0.42434230604623524},
       {1.95, 0.90536166027548337, 1.6333146834761194, 9.4202085363976824, 0.70884415789882904},
       {2, 1, 2.1761658031088089, 104.31778929188269, 0.75636510542245938},
       {3.3, -0.88923267326732802, 5.7858910891089099, 3.0940594059406195, 1.2459072647873599}});
  for (const double t : {-3.3, 0.7, 1.99}) {
    EXPECT_NEAR(table.value(0, t + 2000), table.value(0, t), 1e-11);
    EXPECT_NEAR(table.integral(0, t + 2000) - table.integral(0, t), 1000 * 0.75636510542245938,
                1e-9);
  }
}

TEST(TimeTable, LinearByHand) {
  const TimeTable table({{1, 4, 0}, {2, 6, 1}, {4, 0, 1}}, linear, false);
  ASSERT_EQ(table.columns(), 2U);
  expect_all(table, 0,
             {{0, 4, 0, 0, 0},
              {0.5, 4, 0, 0, 2},
              {1, 4, 2, 0, 4},  // from the right
              {1.5, 5, 2, 0, 6.25},
              {2, 6, -3, 0, 9},
              {3, 3, -3, 0, 13.5},
              {4, 0, 0, 0, 15},
              {9, 0, 0, 0, 15}});
  expect_all(table, 1, {{-7, 0, 0, 0, 0}, {1.5, 0.5, 1, 0, 0.125}, {6, 1, 0, 0, 4.5}});
}

/// Rows before 0: the integral begins at 0 all the same.
TEST(TimeTable, TheIntegralBeginsAtZero) {
  const TimeTable table({{-3, 1}, {-2, 5}, {2, 5}}, linear, false);
  EXPECT_NEAR(table.integral(0, 1), 5, 1e-15);
  EXPECT_NEAR(table.integral(0, -1), -5, 1e-15);
  EXPECT_NEAR(table.integral(0, -4), -5 * 2 - 3 - 1, 1e-14);
}

TEST(TimeTable, PeriodicLinear) {
  const TimeTable saw({{0.5, 0}, {1, 1}, {2.5, 0}}, linear, true);  // a period of 2
  EXPECT_NEAR(saw.value(0, 0.75), 0.5, 1e-15);
  EXPECT_NEAR(saw.value(0, 0.25), 0.25 / 1.5, 1e-15);
  EXPECT_NEAR(saw.value(0, -3.25), 0.5, 1e-14);
  EXPECT_NEAR(saw.rate(0, 100.5), 2, 1e-14);
  EXPECT_NEAR(saw.integral(0, 8) - saw.integral(0, 0), 4 * 1.0, 1e-13);
}

/// No value passes its rows by, and rates are no larger than largest_rate() says.
TEST(TimeTable, Bounds) {
  for (const bool periodic : {false, true}) {
    Rows rows = uneven;
    if (periodic) rows.back()[1] = rows.front()[1];
    for (const auto how : {linear, smooth}) {
      const TimeTable table(rows, how, periodic);
      double most = 0, fastest = 0;
      for (double t = -1; t < 5; t += 1e-3) {
        most = std::max(most, std::abs(table.value(0, t)));
        fastest = std::max(fastest, std::abs(table.rate(0, t)));
        EXPECT_LE(table.value(0, t), 4);
        EXPECT_GE(table.value(0, t), -1.25);
      }
      EXPECT_NEAR(table.largest(0), most, 1e-5);
      EXPECT_LE(fastest, table.largest_rate(0) + 1e-12);
      EXPECT_NEAR(table.largest_rate(0), fastest, 2e-2);
    }
  }
}

TEST(TimeTable, TimesOfRows) {
  const TimeTable once({{-1, 0}, {0, 1}, {2, 1}, {3, 0}}, linear, false);
  EXPECT_EQ(once.times_until(2.5), (std::vector<double>{2}));
  const TimeTable cycle({{1, 0}, {2, 1}, {3, 0}}, linear, true);
  EXPECT_EQ(cycle.times_until(5), (std::vector<double>{1, 2, 3, 4, 5}));
  EXPECT_TRUE(TimeTable().times_until(5).empty());
}

TEST(TimeTable, RefusesWhatIsNoTable) {
  EXPECT_THROW(TimeTable({{0, 1}}, linear, false), std::invalid_argument);
  EXPECT_THROW(TimeTable({{0, 1}, {0, 2}}, linear, false), std::invalid_argument);
  EXPECT_THROW(TimeTable({{0, 1}, {1}}, linear, false), std::invalid_argument);
  EXPECT_THROW(TimeTable({{0, 1}, {1, 2}}, linear, true), std::invalid_argument);
}

}  // namespace
}  // namespace floe
