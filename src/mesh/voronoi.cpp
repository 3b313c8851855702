#include "mesh/voronoi.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace floe::mesh {

Voronoi::Voronoi(const SheetPlan& plan, std::vector<Point2> generators, const Share& share)
    : l_(plan.element_size),
      x1_(plan.length / 2),
      y1_(plan.width / 2),
      distance_(3 * std::max(plan.element_size, std::sqrt(plan.length * plan.width /
                                                          static_cast<double>(generators.size())))),
      share_(share),
      generators_(std::move(generators)) {
  frame();
  update_cells();
}

void Voronoi::move(std::vector<Point2> generators) {
  generators_ = std::move(generators);
  delaunay_.move(generators_, share_);
  update_cells();
}

/// Triangulates the generators and the guards, which stand two per distance_ on a rectangle around
/// the plan.
void Voronoi::frame() {
  std::vector<Point2> points = generators_;
  const double x = x1_ + distance_, y = y1_ + distance_;
  const auto along = [&](const Point2& from, const Point2& to) {  // without the end point
    const double extent = std::abs(to[0] - from[0]) + std::abs(to[1] - from[1]);
    const auto n = static_cast<int>(std::ceil(2 * extent / distance_));
    for (int k = 0; k < n; ++k)
      points.push_back({from[0] + (to[0] - from[0]) * k / n, from[1] + (to[1] - from[1]) * k / n});
  };
  along({-x, -y}, {x, -y});
  along({x, -y}, {x, y});
  along({x, y}, {-x, y});
  along({-x, y}, {-x, -y});
  delaunay_.build(std::move(points));
}

namespace {

/// Marks a cell next to a guard that stands too near; the mark reaches the other ranks with the
/// cells.
constexpr Cell open{-1e300, {}, 0};
bool is_open(const Cell& cell) { return cell.area == open.area; }

}  // namespace

void Voronoi::update_cells() {
  const auto n = static_cast<std::int32_t>(generators_.size());
  cells_.resize(generators_.size());
  for (;;) {
    const bool covered = cover(share_.begin(n), share_.end(n));
    share_.gather(cells_);
    if (share_.size == 1 ? covered : std::none_of(cells_.begin(), cells_.end(), is_open)) return;
    distance_ *= 2;
    frame();
  }
}

/// Computes the cells first ... last-1. \return false if a guard's cell reaches into the plan
bool Voronoi::cover(std::int32_t first, std::int32_t last) {
  circumcentres(first, last);
  const auto n = static_cast<std::int32_t>(generators_.size());
  for (std::int32_t k = first; k < last; ++k) {
    const std::int32_t begin = delaunay_.outgoing(k);
    std::int32_t e = begin;
    std::uint8_t out = 0;
    polygon_.clear();
    do {
      polygon_.push_back(centre_[e / 3]);
      out |= out_[e / 3];
      if (delaunay_.origin(Delaunay::next(e)) >= n && !guard_stays_out(e)) {
        cells_[k] = open;
        return false;
      }
      e = delaunay_.turn(e);
    } while (e != begin);
    if (out) clip();

    const Point2 z = generators_[k];
    double area2 = 0, sx = 0, sy = 0, polar = 0;
    double ax = polygon_.back()[0] - z[0], ay = polygon_.back()[1] - z[1];
    for (const Point2& p : polygon_) {
      const double bx = p[0] - z[0], by = p[1] - z[1];
      const double c = ax * by - bx * ay;
      area2 += c;
      sx += c * (ax + bx);
      sy += c * (ay + by);
      polar += c * (ax * ax + ax * bx + bx * bx + ay * ay + ay * by + by * by);
      ax = bx, ay = by;
    }
    const double third =
        area2 > 0 ? 1 / (3 * area2) : 0;  // no area: two generators (almost) coincide
    cells_[k] = {area2 / 2, {z[0] + sx * third, z[1] + sy * third}, polar / 12};
  }
  return true;
}

/// Computes the circumcentres of all triangles with a corner among the generators first ... last-1.
void Voronoi::circumcentres(std::int32_t first, std::int32_t last) {
  const std::int32_t triangles = delaunay_.triangles();
  const auto& points = delaunay_.points();
  centre_.resize(triangles);
  out_.resize(triangles);
  const auto mine = [&](std::int32_t v) { return v >= first && v < last; };
  for (std::int32_t t = 0; t < triangles; ++t) {
    const std::int32_t a = delaunay_.origin(3 * t), b = delaunay_.origin(3 * t + 1),
                       c = delaunay_.origin(3 * t + 2);
    if (!mine(a) && !mine(b) && !mine(c)) continue;
    const Point2& o = points[a];
    const double bx = points[b][0] - o[0], by = points[b][1] - o[1];
    const double cx = points[c][0] - o[0], cy = points[c][1] - o[1];
    const double scale = 0.5 / (bx * cy - by * cx);
    const double b2 = bx * bx + by * by, c2 = cx * cx + cy * cy;
    centre_[t] = {o[0] + (cy * b2 - by * c2) * scale, o[1] + (bx * c2 - cx * b2) * scale};
    out_[t] = outcode(centre_[t]);
  }
}

std::uint8_t Voronoi::outcode(const Point2& p) const {
  return static_cast<std::uint8_t>((p[0] < -x1_ ? side_left : 0) | (p[0] > x1_ ? side_right : 0) |
                                   (p[1] < -y1_ ? side_bottom : 0) | (p[1] > y1_ ? side_top : 0));
}

/// Whether the edge between the cells of the generator origin(e) and of the guard at its other end
/// lies outside the plan.
bool Voronoi::guard_stays_out(std::int32_t e) const {
  const std::int32_t f = delaunay_.twin(e);  // never -1: a generator is not on the hull
  if (out_[e / 3] & out_[f / 3]) return true;
  // The edge may pass a corner outside: then the whole plan is on the generator's side of the
  // bisector.
  const Point2& z = delaunay_.points()[delaunay_.origin(e)];
  const Point2& g = delaunay_.points()[delaunay_.origin(f)];
  const double nx = g[0] - z[0], ny = g[1] - z[1];
  const double middle = (nx * (g[0] + z[0]) + ny * (g[1] + z[1])) / 2;
  return std::abs(nx) * x1_ + std::abs(ny) * y1_ < middle;
}

/// Clips polygon_ to the plan, side by side (Sutherland & Hodgman 1974). Crossings are computed
/// from the inner end of an edge, so that both cells of a facet get the same bits, and lie exactly
/// on the side.
void Voronoi::clip() {
  for (int side = 0; side < 4; ++side) {
    const int axis = side / 2, other = 1 - axis;
    const double sign = side % 2 ? 1 : -1, limit = axis ? y1_ : x1_;
    const auto inside = [&](const Point2& p) { return sign * p[axis] <= limit; };
    const auto crossing = [&](const Point2& in, const Point2& out) {
      const double t = (sign * limit - in[axis]) / (out[axis] - in[axis]);
      Point2 p;
      p[axis] = sign * limit;
      p[other] = in[other] + t * (out[other] - in[other]);
      return p;
    };
    if (std::all_of(polygon_.begin(), polygon_.end(), inside)) continue;
    scratch_.clear();
    Point2 p = polygon_.back();
    for (const Point2& q : polygon_) {
      if (inside(p) != inside(q)) scratch_.push_back(inside(p) ? crossing(p, q) : crossing(q, p));
      if (inside(q)) scratch_.push_back(q);
      p = q;
    }
    std::swap(polygon_, scratch_);
  }
}

namespace {

/// Returns the distance along a Hilbert curve of order 31 (after Warren, Hacker's Delight, ch. 16).
std::uint64_t hilbert_index(std::uint32_t x, std::uint32_t y) {
  std::uint64_t index = 0;
  for (std::uint32_t s = 1u << 30; s > 0; s >>= 1) {
    const bool right = x & s, up = y & s;
    index = 4 * index + (right ? (up ? 2 : 3) : (up ? 1 : 0));
    if (!up) {
      if (right) {
        x = ~x;
        y = ~y;
      }
      std::swap(x, y);
    }
  }
  return index;
}

}  // namespace

std::vector<std::int32_t> hilbert_order(std::span<const Point2> points, double length,
                                        double width) {
  // The cells of the curve are squares, also over a long plan.
  const double scale = 2147483647.0 / std::max(length, width);
  std::vector<std::pair<std::uint64_t, std::int32_t>> key(points.size());
  for (std::size_t k = 0; k < points.size(); ++k) {
    const auto grid = [scale](double x) {
      return static_cast<std::uint32_t>(std::clamp(x * scale, 0.0, 2147483647.0));
    };
    key[k] = {hilbert_index(grid(points[k][0] + length / 2), grid(points[k][1] + width / 2)),
              static_cast<std::int32_t>(k)};
  }
  std::sort(key.begin(), key.end());
  std::vector<std::int32_t> order(points.size());
  for (std::size_t k = 0; k < key.size(); ++k) order[k] = key[k].second;
  return order;
}

std::vector<Point2> permuted(std::span<const Point2> points, std::span<const std::int32_t> order) {
  std::vector<Point2> result(points.size());
  for (std::size_t k = 0; k < points.size(); ++k) result[k] = points[order[k]];
  return result;
}

}  // namespace floe::mesh
