// Sine and cosine of lanes against the library's.
#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "base/sine_cosine.h"
#include "support/random.h"

namespace floe {
namespace {

constexpr double pi = 3.14159265358979323846;

/// Angles of all sizes, multiples of pi/4 and their neighbours.
std::vector<double> angles() {
  test::Random random(4);
  std::vector<double> all{0, -0.0, 1e-300, 5e-324, 0.785, -0.785, 1e5, -9.9e5};
  for (int k = -40; k <= 40; ++k) {
    for (const double step : {0.0, 1e-16, -1e-16, 1e-9, -1e-9}) all.push_back(k * pi / 4 + step);
  }
  for (const double size : {1e-8, 1e-3, 0.7, 3.0, 100.0, 1e6, 1e9}) {
    for (int k = 0; k < 2000; ++k) all.push_back(random.uniform(-size, size));
  }
  return all;
}

TEST(SineCosine, OfLanesAreTheLibrarysToTheLastPlaces) {
  for (const double angle : angles()) {
    const SineCosine<Lanes> f = sine_cosine(Lanes(angle));
    const double s = std::sin(angle), c = std::cos(angle);
    constexpr double last_places = 3e-16;  // relative
    // Beyond a quarter of a turn the reduction leaves 1e-22 of the angle: it shows near zeros.
    const double rest = 1e-21 * std::abs(angle);
    EXPECT_NEAR(f.sine[0], s, last_places * std::abs(s) + rest) << angle;
    EXPECT_NEAR(f.cosine[0], c, last_places * std::abs(c) + rest) << angle;
  }
}

TEST(SineCosine, OfALaneDoNotDependOnTheOthers) {
  for (const double angle : angles()) {
    const SineCosine<Lanes> alone = sine_cosine(Lanes(angle));
    for (const double other : {0.1, 2.0, -1e8}) {
      Lanes mixed(other);
      mixed[0] = angle;
      const SineCosine<Lanes> f = sine_cosine(mixed);
      EXPECT_EQ(f.sine[0], alone.sine[0]) << angle;
      EXPECT_EQ(f.cosine[0], alone.cosine[0]) << angle;
    }
  }
}

TEST(SineCosine, OfWhatIsNotFiniteAreNotNumbers) {
  for (const double angle :
       {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()}) {
    const SineCosine<Lanes> f = sine_cosine(Lanes(angle));
    EXPECT_TRUE(std::isnan(f.sine[0]) && std::isnan(f.cosine[0]));
  }
}

}  // namespace
}  // namespace floe
