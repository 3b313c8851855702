#include "floe/mesh/outline.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <span>

#include "floe/geometry/polyhedron.h"
#include "mesh/outline_area.h"

namespace floe {
namespace {

/// Calls visit(a, b) for each edge of a ring.
template <class Visit>
void each_edge(const Ring& ring, Visit&& visit) {
  for (std::size_t k = 0; k < ring.size(); ++k) visit(ring[k], ring[(k + 1) % ring.size()]);
}

void extend(PlanBox& box, const Ring& ring) {
  for (const Point2& p : ring) {
    for (std::size_t axis = 0; axis < 2; ++axis) {
      box.least[axis] = std::min(box.least[axis], p[axis]);
      box.most[axis] = std::max(box.most[axis], p[axis]);
    }
  }
}

constexpr double unbounded = std::numeric_limits<double>::infinity();
constexpr PlanBox nothing{{unbounded, unbounded}, {-unbounded, -unbounded}};

}  // namespace

Outline::Outline(std::vector<RingedPolygon> polygons) : polygons_(std::move(polygons)) {
  for (RingedPolygon& polygon : polygons_) {
    for (Ring& ring : polygon) {
      ring.erase(std::unique(ring.begin(), ring.end()), ring.end());
      while (ring.size() > 1 && ring.back() == ring.front()) ring.pop_back();
      const bool is_outer = &ring == &polygon.front();
      if ((mesh::signed_area(ring) > 0) != is_outer) std::reverse(ring.begin(), ring.end());
    }
  }
}

std::size_t Outline::corners() const {
  std::size_t sum = 0;
  for (const RingedPolygon& polygon : polygons_)
    for (const Ring& ring : polygon) sum += ring.size();
  return sum;
}

double Outline::area() const {
  double sum = 0;
  for (const RingedPolygon& polygon : polygons_)
    for (const Ring& ring : polygon) sum += mesh::signed_area(ring);
  return sum;
}

Point2 Outline::centroid() const {
  const PlanBox all = box();
  const Point2 o{(all.least[0] + all.most[0]) / 2, (all.least[1] + all.most[1]) / 2};
  double area2 = 0;
  Point2 sum{};
  const auto add = [&](const Point2& a, const Point2& b) {
    const double ax = a[0] - o[0], ay = a[1] - o[1], bx = b[0] - o[0], by = b[1] - o[1];
    const double c = ax * by - bx * ay;
    area2 += c;
    sum[0] += c * (ax + bx), sum[1] += c * (ay + by);
  };
  for (const RingedPolygon& polygon : polygons_)
    for (const Ring& ring : polygon) each_edge(ring, add);
  return {o[0] + sum[0] / (3 * area2), o[1] + sum[1] / (3 * area2)};
}

PlanBox box_of(const RingedPolygon& polygon) {
  PlanBox box = nothing;
  for (const Ring& ring : polygon) extend(box, ring);
  return box;
}

PlanBox Outline::box() const {
  PlanBox box = nothing;
  for (const RingedPolygon& polygon : polygons_)
    for (const Ring& ring : polygon) extend(box, ring);
  return box;
}

bool contains(const RingedPolygon& polygon, const Point2& p) {
  bool inside = false;  // by the number of edges to the right of the point
  for (const Ring& ring : polygon) {
    each_edge(ring, [&](const Point2& a, const Point2& b) {
      if ((a[1] > p[1]) == (b[1] > p[1])) return;
      const double x = a[0] + (p[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0]);
      if (x > p[0]) inside = !inside;
    });
  }
  return inside;
}

bool Outline::contains(const Point2& p) const {
  return std::any_of(polygons_.begin(), polygons_.end(),
                     [&](const RingedPolygon& polygon) { return floe::contains(polygon, p); });
}

double Outline::distance(const Point2& p) const {
  double least = unbounded;
  for (const RingedPolygon& polygon : polygons_) {
    for (const Ring& ring : polygon) {
      each_edge(ring, [&](const Point2& a, const Point2& b) {
        const double ex = b[0] - a[0], ey = b[1] - a[1], x = p[0] - a[0], y = p[1] - a[1];
        const double s = std::clamp((ex * x + ey * y) / (ex * ex + ey * ey), 0.0, 1.0);
        least = std::min(least, std::hypot(x - s * ex, y - s * ey));
      });
    }
  }
  return least;
}

std::uint64_t Outline::identity() const {
  std::uint64_t hash = 14695981039346656037U;
  const auto add = [&hash](std::uint64_t word) {
    for (int byte = 0; byte < 8; ++byte)
      hash = (hash ^ (word >> (8 * byte) & 0xffU)) * 1099511628211U;
  };
  for (const RingedPolygon& polygon : polygons_) {
    add(polygon.size());
    for (const Ring& ring : polygon) {
      add(ring.size());
      for (const auto& [x, y] : ring)
        add(std::bit_cast<std::uint64_t>(x)), add(std::bit_cast<std::uint64_t>(y));
    }
  }
  return hash;
}

std::vector<CutLine> clipped(const RingedPolygon& polygon, const CutLine& line) {
  const double dx = line.to[0] - line.from[0], dy = line.to[1] - line.from[1];
  std::vector<double> at{0, 1};  // over the length of the line
  for (const Ring& ring : polygon) {
    each_edge(ring, [&](const Point2& a, const Point2& b) {
      const double ex = b[0] - a[0], ey = b[1] - a[1];
      const double x = a[0] - line.from[0], y = a[1] - line.from[1];
      const double cross = dx * ey - dy * ex;
      if (cross == 0) return;
      const double t = (x * ey - y * ex) / cross, s = (x * dy - y * dx) / cross;
      constexpr double slack = 1e-9;
      if (s >= -slack && s <= 1 + slack && t > 0 && t < 1) at.push_back(t);
    });
  }
  std::sort(at.begin(), at.end());
  const auto point = [&](double t) {
    return t == 1 ? line.to : Point2{line.from[0] + t * dx, line.from[1] + t * dy};
  };
  std::vector<CutLine> parts;
  double last = -1;
  for (std::size_t k = 0; k + 1 < at.size(); ++k) {
    if (!(at[k + 1] > at[k]) || !contains(polygon, point((at[k] + at[k + 1]) / 2))) continue;
    if (last == at[k])
      parts.back().to = point(at[k + 1]);
    else
      parts.push_back({point(at[k]), point(at[k + 1])});
    last = at[k + 1];
  }
  return parts;
}

std::string name_of_ring(const Outline& outline, std::size_t polygon, std::size_t ring) {
  std::string name =
      outline.polygons().size() == 1 ? "the polygon" : "polygon " + std::to_string(polygon + 1);
  if (ring > 0) name += ", hole " + std::to_string(ring);
  return name;
}

}  // namespace floe
