#include "solid/triangle_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "floe/base/item.h"

namespace floe {

double distance(const Point3& point, const Point3& a, const Point3& b, const Point3& c) {
  const Point3 ab = b - a, ac = c - a, ap = point - a;
  const double d1 = dot(ab, ap), d2 = dot(ac, ap);
  if (d1 <= 0 && d2 <= 0) return length(ap);
  const Point3 bp = point - b;
  const double d3 = dot(ab, bp), d4 = dot(ac, bp);
  if (d3 >= 0 && d4 <= d3) return length(bp);
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return length(ap - (d1 / (d1 - d3)) * ab);
  const Point3 cp = point - c;
  const double d5 = dot(ab, cp), d6 = dot(ac, cp);
  if (d6 >= 0 && d5 <= d6) return length(cp);
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return length(ap - (d2 / (d2 - d6)) * ac);
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0)
    return length(bp - ((d4 - d3) / ((d4 - d3) + (d5 - d6))) * (c - b));
  const double sum = va + vb + vc;
  if (!(sum > 0)) return std::min({length(ap), length(bp), length(cp)});
  return length(ap - (vb / sum) * ab - (vc / sum) * ac);
}

TriangleTree::TriangleTree(const Surface& surface) : surface_(surface) {
  order_.resize(surface.triangles.size());
  std::iota(order_.begin(), order_.end(), 0);
  if (!order_.empty()) build(0, static_cast<std::int32_t>(order_.size()));
}

void TriangleTree::build(std::int32_t first, std::int32_t end) {
  constexpr double far = std::numeric_limits<double>::infinity();
  constexpr std::int32_t leaf = 4;
  Node node{{far, far, far}, {-far, -far, -far}, first, end, -1};
  for (std::int32_t k = first; k < end; ++k) {
    for (const std::int32_t v : item(surface_.triangles, item(order_, k))) {
      const Point3& p = item(surface_.vertices, v);
      for (std::size_t i = 0; i < 3; ++i) {
        node.low[i] = std::min(node.low[i], p[i]);
        node.high[i] = std::max(node.high[i], p[i]);
      }
    }
  }
  const auto index = static_cast<std::int32_t>(nodes_.size());
  nodes_.push_back(node);
  if (end - first <= leaf) return;
  std::size_t axis = 0;
  const Point3 size = node.high - node.low;
  for (std::size_t i = 1; i < 3; ++i)
    if (size[i] > size[axis]) axis = i;
  const auto key = [&](std::int32_t t) {
    double sum = 0;
    for (const std::int32_t v : item(surface_.triangles, t))
      sum += item(surface_.vertices, v)[axis];
    return sum;
  };
  const std::int32_t half = first + (end - first) / 2;
  std::sort(order_.begin() + first, order_.begin() + end, [&](std::int32_t s, std::int32_t t) {
    const double ks = key(s), kt = key(t);
    return ks < kt || (ks == kt && s < t);
  });
  build(first, half);
  item(nodes_, index).right = static_cast<std::int32_t>(nodes_.size());
  build(half, end);
}

double TriangleTree::box_distance2(const Node& node, const Point3& point) const {
  double sum = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const double beyond = std::max({node.low[i] - point[i], point[i] - node.high[i], 0.0});
    sum += beyond * beyond;
  }
  return sum;
}

double TriangleTree::distance_from(std::int32_t t, const Point3& point) const {
  const auto& [a, b, c] = item(surface_.triangles, t);
  return distance(point, item(surface_.vertices, a), item(surface_.vertices, b),
                  item(surface_.vertices, c));
}

TriangleTree::Nearest TriangleTree::nearest(const Point3& point) const {
  Nearest best{std::numeric_limits<double>::infinity(), 0};
  std::array<std::int32_t, 64> stack{};  // the tree is balanced: its depth is below 32
  std::size_t size = 1;
  while (size > 0) {
    const std::int32_t index = stack[--size];
    const Node& node = item(nodes_, index);
    if (box_distance2(node, point) >= best.distance * best.distance) continue;
    if (node.right < 0) {
      for (std::int32_t k = node.first; k < node.end; ++k) {
        const double d = distance_from(item(order_, k), point);
        if (d < best.distance) best = {d, item(order_, k)};
      }
      continue;
    }
    const std::int32_t left = index + 1, right = node.right;
    const bool left_first =
        box_distance2(item(nodes_, left), point) <= box_distance2(item(nodes_, right), point);
    stack[size++] = left_first ? right : left;
    stack[size++] = left_first ? left : right;
  }
  return best;
}

}  // namespace floe
