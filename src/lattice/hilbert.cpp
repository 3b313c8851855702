#include <algorithm>
#include <array>
#include <cstdint>
#include <numeric>

#include "floe/base/item.h"
#include "lattice/partition.h"

namespace floe {
namespace {

constexpr int bits = 20;  // per axis: 60-bit keys, cells of a millionth of the extent

/// Returns the index along the three-dimensional Hilbert curve of a point with integer coordinates
/// (Skilling 2004, "Programming the Hilbert curve", AIP Conf. Proc. 707, 381: axes to transpose).
/// CGAL's hilbert_sort is not used: its median splits put points with equal coordinates (every flat
/// sheet) in arbitrary order.
std::uint64_t hilbert_key(std::array<std::uint32_t, 3> x) {
  constexpr std::uint32_t top = 1U << (bits - 1);
  for (std::uint32_t q = top; q > 1; q >>= 1) {
    const std::uint32_t below = q - 1;
    for (std::size_t i = 0; i < 3; ++i) {
      if (x[i] & q) {
        x[0] ^= below;
      } else {
        const std::uint32_t t = (x[0] ^ x[i]) & below;
        x[0] ^= t;
        x[i] ^= t;
      }
    }
  }
  x[1] ^= x[0];
  x[2] ^= x[1];
  std::uint32_t t = 0;
  for (std::uint32_t q = top; q > 1; q >>= 1) {
    if (x[2] & q) t ^= q - 1;
  }
  std::uint64_t key = 0;
  for (int bit = bits - 1; bit >= 0; --bit) {
    for (const std::uint32_t axis : x) key = key << 1 | (((axis ^ t) >> bit) & 1U);
  }
  return key;
}

}  // namespace

std::vector<std::int32_t> hilbert_order(const std::vector<Point3>& points) {
  Point3 low{}, high{};
  if (!points.empty()) low = high = points.front();
  for (const Point3& p : points) {
    for (std::size_t a = 0; a < 3; ++a) {
      low[a] = std::min(low[a], p[a]);
      high[a] = std::max(high[a], p[a]);
    }
  }
  const double extent = std::max({high[0] - low[0], high[1] - low[1], high[2] - low[2]});
  const double scale = extent > 0 ? ((1U << bits) - 1) / extent : 0.0;
  std::vector<std::uint64_t> keys(points.size());
  for (std::size_t k = 0; k < points.size(); ++k) {
    std::array<std::uint32_t, 3> x{};
    for (std::size_t a = 0; a < 3; ++a)
      x[a] = static_cast<std::uint32_t>((points[k][a] - low[a]) * scale);
    keys[k] = hilbert_key(x);
  }
  std::vector<std::int32_t> order(points.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::int32_t a, std::int32_t b) { return item(keys, a) < item(keys, b); });
  return order;
}

}  // namespace floe
