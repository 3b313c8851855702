#include "contact/broad_phase.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "floe/base/item.h"

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

/// The spheres, and the pairs that are found among them.
class NeighbourSearch {
 public:
  NeighbourSearch(std::span<const Vec3<double>> centres, std::span<const double> radii,
                  double reach, std::span<const std::uint8_t> wanted, std::vector<BodyPair>& pairs);

  /// Tests the large spheres against all spheres.
  void test_large() const;
  /// Tests all other spheres against each other, by the grid.
  void test_grid() const;

 private:
  bool is_left_out(std::size_t b) const { return radii_[b] < 0; }
  /// The few bodies that are far larger than the mean are not in the grid: cells of their size
  /// would hold too many of the other bodies.
  bool is_large(std::size_t b) const { return radii_[b] > large_; }
  void test(std::int32_t i, std::int32_t j) const;
  std::vector<Cell> cells() const;

  std::span<const Vec3<double>> centres_;
  std::span<const double> radii_;
  double reach_;
  std::span<const std::uint8_t> wanted_;
  std::vector<BodyPair>& pairs_;
  double large_ = 0;  ///< radius above which a sphere is large [m]
  double size_ = 0;   ///< of the cells [m]
};

NeighbourSearch::NeighbourSearch(std::span<const Vec3<double>> centres,
                                 std::span<const double> radii, double reach,
                                 std::span<const std::uint8_t> wanted, std::vector<BodyPair>& pairs)
    : centres_(centres), radii_(radii), reach_(reach), wanted_(wanted), pairs_(pairs) {
  constexpr double far_larger = 4;
  double mean = 0;
  for (const double r : radii) mean += std::max(r, 0.0) / static_cast<double>(radii.size());
  large_ = far_larger * mean;
  for (std::size_t b = 0; b < radii.size(); ++b)
    if (!is_left_out(b) && !is_large(b)) size_ = std::max(size_, 2 * radii[b] + reach);
}

void NeighbourSearch::test(std::int32_t i, std::int32_t j) const {
  const auto a = static_cast<std::size_t>(i), b = static_cast<std::size_t>(j);
  if (wanted_[a] == 0 && wanted_[b] == 0) return;
  const Vec3<double> d = centres_[a] - centres_[b];
  const double most = radii_[a] + radii_[b] + reach_;
  if (dot(d, d) <= most * most) pairs_.push_back({std::min(i, j), std::max(i, j)});
}

void NeighbourSearch::test_large() const {
  for (std::size_t i = 0; i < centres_.size(); ++i) {
    if (is_left_out(i) || !is_large(i)) continue;
    for (std::size_t j = 0; j < centres_.size(); ++j) {
      if (is_left_out(j) || (is_large(j) && j <= i)) continue;
      test(static_cast<std::int32_t>(i), static_cast<std::int32_t>(j));
    }
  }
}

/// Returns the cell of each sphere that is in the grid, sorted.
std::vector<Cell> NeighbourSearch::cells() const {
  Vec3<double> low{std::numeric_limits<double>::max(), std::numeric_limits<double>::max(),
                   std::numeric_limits<double>::max()};
  for (const auto& c : centres_)
    low = {std::min(low.x, c.x), std::min(low.y, c.y), std::min(low.z, c.z)};
  constexpr double farthest = 1e9;  // bodies that fly off to infinity share the last cell
  const auto place = [&](double x) {
    return static_cast<std::int32_t>(std::min(std::floor(x / size_), farthest));
  };
  std::vector<Cell> cells;
  cells.reserve(centres_.size());
  for (std::size_t b = 0; b < centres_.size(); ++b) {
    if (is_left_out(b) || is_large(b)) continue;
    const Vec3<double> r = centres_[b] - low;
    cells.push_back(
        {.place = {place(r.x), place(r.y), place(r.z)}, .body = static_cast<std::int32_t>(b)});
  }
  std::sort(cells.begin(), cells.end());
  return cells;
}

/// Each cell is tested with itself and with half of its neighbours: the cell above it and four
/// columns beside it. For each of these columns an index runs through the sorted cells, since the
/// cells and their neighbours come in the same order.
void NeighbourSearch::test_grid() const {
  const std::vector<Cell> cells = this->cells();
  const std::array<std::array<std::int32_t, 2>, 4> columns{{{0, 1}, {1, -1}, {1, 0}, {1, 1}}};
  std::array<std::size_t, 4> first_near{};
  for (std::size_t k = 0; k < cells.size(); ++k) {
    const auto [x, y, z] = cells[k].place;
    for (std::size_t m = k + 1; m < cells.size() && cells[m].place[0] == x &&
                                cells[m].place[1] == y && cells[m].place[2] <= z + 1;
         ++m)
      test(cells[k].body, cells[m].body);
    for (std::size_t n = 0; n < columns.size(); ++n) {
      const auto [dx, dy] = columns[n];
      const std::array first{x + dx, y + dy, z - 1}, last{x + dx, y + dy, z + 1};
      std::size_t& begin = first_near[n];
      while (begin < cells.size() && cells[begin].place < first) ++begin;
      for (std::size_t m = begin; m < cells.size() && cells[m].place <= last; ++m)
        test(cells[k].body, cells[m].body);
    }
  }
}

/// Spheres in the first period, and images of those near its lower ends beyond its upper ones.
struct Images {
  std::vector<Vec3<double>> centres;
  std::vector<double> radii;
  std::vector<std::uint8_t> wanted;
  std::vector<std::int32_t> of;  ///< the sphere of each

  void add(const Vec3<double>& centre, double radius, std::uint8_t want, std::int32_t sphere) {
    centres.push_back(centre), radii.push_back(radius);
    wanted.push_back(want), of.push_back(sphere);
  }
};

Images images_of(std::span<const Vec3<double>> centres, std::span<const double> radii, double reach,
                 std::span<const std::uint8_t> wanted, const Periods& periods) {
  double largest = 0;
  for (const double r : radii) largest = std::max(largest, r);
  const double margin = 2 * largest + reach;
  const auto into = [](double x, double period) {
    return period > 0 ? x - period * std::floor(x / period) : x;
  };
  Images all;
  for (std::size_t b = 0; b < centres.size(); ++b) {
    const auto& [lx, ly, lz] = periods.length;
    const Vec3<double> c{into(centres[b].x, lx), into(centres[b].y, ly), centres[b].z};
    const auto add = [&](double dx, double dy) {
      all.add({c.x + dx, c.y + dy, c.z}, radii[b], wanted[b], static_cast<std::int32_t>(b));
    };
    const bool low_x = lx > 0 && c.x<margin, low_y = ly> 0 && c.y < margin;
    add(0, 0);
    if (low_x) add(lx, 0);
    if (low_y) add(0, ly);
    if (low_x && low_y) add(lx, ly);
  }
  return all;
}

void search(std::span<const Vec3<double>> centres, std::span<const double> radii, double reach,
            std::span<const std::uint8_t> wanted, std::vector<BodyPair>& pairs) {
  pairs.clear();
  const NeighbourSearch search(centres, radii, reach, wanted, pairs);
  search.test_large();
  search.test_grid();
}

}  // namespace

void near_pairs(std::span<const Vec3<double>> centres, std::span<const double> radii, double reach,
                std::span<const std::uint8_t> wanted, std::vector<BodyPair>& pairs,
                const Periods& periods) {
  if (!periods.any()) {
    search(centres, radii, reach, wanted, pairs);
    return;
  }
  const Images all = images_of(centres, radii, reach, wanted, periods);
  search(all.centres, all.radii, reach, all.wanted, pairs);
  for (BodyPair& pair : pairs) {
    const auto [a, b] = pair;
    pair = {item(all.of, a), item(all.of, b)};
    if (pair[0] > pair[1]) std::swap(pair[0], pair[1]);
  }
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  std::erase_if(pairs, [](const BodyPair& pair) { return pair[0] == pair[1]; });
}

}  // namespace floe
