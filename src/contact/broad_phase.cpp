#include "contact/broad_phase.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace floe {
namespace {

struct Cell {
  std::array<std::int32_t, 3> place;
  std::int32_t body;
  /// Sorts by x first and z last, so that the cells of a column along z follow each other.
  bool operator<(const Cell& other) const {
    return place != other.place ? place < other.place : body < other.body;
  }
};

}  // namespace

void near_pairs(std::span<const Vec3<double>> centres, std::span<const double> radii, double reach,
                std::span<const std::uint8_t> wanted, std::vector<BodyPair>& pairs) {
  pairs.clear();
  // The few bodies that are far larger than the mean are tested against all others: cells of their
  // size would hold too many of the other bodies.
  constexpr double far_larger = 4;
  double mean = 0, size = 0;
  for (const double r : radii) mean += std::max(r, 0.0) / static_cast<double>(radii.size());
  const auto is_large = [&](std::size_t b) { return radii[b] > far_larger * mean; };
  for (std::size_t b = 0; b < radii.size(); ++b)
    if (radii[b] >= 0 && !is_large(b)) size = std::max(size, 2 * radii[b] + reach);
  Vec3<double> low{std::numeric_limits<double>::max(), std::numeric_limits<double>::max(),
                   std::numeric_limits<double>::max()};
  for (const auto& c : centres)
    low = {std::min(low.x, c.x), std::min(low.y, c.y), std::min(low.z, c.z)};
  std::vector<Cell> cells;
  cells.reserve(centres.size());
  constexpr double farthest = 1e9;  // bodies that fly off to infinity share the last cell
  const auto place = [&](double x) {
    return static_cast<std::int32_t>(std::min(std::floor(x / size), farthest));
  };
  for (std::size_t b = 0; b < centres.size(); ++b) {
    if (radii[b] < 0 || is_large(b)) continue;
    const Vec3<double> r = centres[b] - low;
    cells.push_back({{place(r.x), place(r.y), place(r.z)}, static_cast<std::int32_t>(b)});
  }
  std::sort(cells.begin(), cells.end());

  const auto test = [&](std::int32_t i, std::int32_t j) {
    const auto a = static_cast<std::size_t>(i), b = static_cast<std::size_t>(j);
    if (wanted[a] == 0 && wanted[b] == 0) return;
    const Vec3<double> d = centres[a] - centres[b];
    const double most = radii[a] + radii[b] + reach;
    if (dot(d, d) <= most * most) pairs.push_back({std::min(i, j), std::max(i, j)});
  };
  for (std::size_t i = 0; i < centres.size(); ++i) {
    if (radii[i] < 0 || !is_large(i)) continue;
    for (std::size_t j = 0; j < centres.size(); ++j) {
      if (radii[j] < 0 || (is_large(j) && j <= i)) continue;
      test(static_cast<std::int32_t>(i), static_cast<std::int32_t>(j));
    }
  }
  // Each cell is tested with itself and with half of its neighbours: the cell above it and four
  // columns beside it. For each of these columns an index runs through the sorted cells, since the
  // cells and their neighbours come in the same order.
  const std::array<std::array<std::int32_t, 2>, 4> columns{{{0, 1}, {1, -1}, {1, 0}, {1, 1}}};
  std::array<std::size_t, 4> at{};
  for (std::size_t k = 0; k < cells.size(); ++k) {
    const Cell& c = cells[k];
    for (std::size_t m = k + 1;
         m < cells.size() && cells[m].place[0] == c.place[0] && cells[m].place[1] == c.place[1] &&
         cells[m].place[2] <= c.place[2] + 1;
         ++m)
      test(c.body, cells[m].body);
    for (std::size_t n = 0; n < columns.size(); ++n) {
      const std::int32_t x = c.place[0] + columns[n][0], y = c.place[1] + columns[n][1];
      const std::array<std::int32_t, 3> first{x, y, c.place[2] - 1}, last{x, y, c.place[2] + 1};
      while (at[n] < cells.size() && cells[at[n]].place < first) ++at[n];
      for (std::size_t m = at[n]; m < cells.size() && cells[m].place <= last; ++m)
        test(c.body, cells[m].body);
    }
  }
}

}  // namespace floe
