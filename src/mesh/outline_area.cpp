#include "mesh/outline_area.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <span>

#include "floe/geometry/polyhedron.h"

namespace floe::mesh {
namespace {

/// Calls visit(k, chain) for each edge k of a simplified ring, with the given corners from its
/// first to its last.
template <class Visit>
void each_chain(const Ring& given, const Ring& fewer, Visit&& visit) {
  std::vector<Point2> chain;
  std::size_t at = 0;
  for (std::size_t k = 0; k < fewer.size(); ++k) {
    const Point2& end = fewer[(k + 1) % fewer.size()];
    chain.assign(1, fewer[k]);
    do {
      at = (at + 1) % given.size();
      chain.push_back(given[at]);
    } while (given[at] != end);
    visit(k, std::span<const Point2>(chain));
  }
}

/// Coordinates along an edge from its first corner, and to its right.
struct EdgeFrame {
  Point2 origin, along;
  double length;
  EdgeFrame(const Point2& a, const Point2& b)
      : origin(a), length(std::hypot(b[0] - a[0], b[1] - a[1])) {
    along = {(b[0] - a[0]) / length, (b[1] - a[1]) / length};
  }
  Point2 right() const { return {along[1], -along[0]}; }
  Point2 local(const Point2& p) const {
    const double x = p[0] - origin[0], y = p[1] - origin[1];
    return {along[0] * x + along[1] * y, along[1] * x - along[0] * y};
  }
};

/// An edge that is to move.
struct Edge {
  std::array<std::size_t, 2> corners;
  Point2 right;
  double length;
  double mean = 0;  ///< of the chain's distance to the right of the edge [m]
  double slope =
      0;  ///< how much the chain's right side grows from the first to the last corner [m]
};

/// Mean and slope of a chain beside its edge.
void measure(std::span<const Point2> chain, Edge& edge) {
  const EdgeFrame frame(chain.front(), chain.back());
  double area = 0, moment = 0, most = 0;
  Point2 last{0, 0};
  for (const Point2& p : chain.subspan(1)) {
    const Point2 next = frame.local(p);
    const double part = (next[0] - last[0]) * (next[1] + last[1]) / 2;
    area += part, moment += part * ((next[0] + last[0]) / 2 / frame.length - 0.5);
    most = std::max(most, std::abs(next[1]));
    last = next;
  }
  // No more than the chain itself goes, whatever its loops.
  edge.mean = std::clamp(area / frame.length, -most, most);
  edge.slope = std::clamp(12 * moment / frame.length, -most, most);
}

using Moves = std::vector<Point2>;

double dot(const Moves& a, const Moves& b) {
  double sum = 0;
  for (std::size_t k = 0; k < a.size(); ++k) sum += a[k][0] * b[k][0] + a[k][1] * b[k][1];
  return sum;
}

/// The moves of corners with the least sum over edges of
/// length ((mean of the edge's move - mean)^2 + (slope of the move - slope)^2/12) and a little of
/// the moves' squares; by conjugate gradients.
Moves fitted(const std::vector<Edge>& edges, std::size_t corners) {
  constexpr double little = 0.05;
  std::vector<double> inertia(corners, 0.0);
  Moves force(corners, Point2{});
  const auto add = [](const Edge& e, double mean, double slope, Moves& to) {
    for (std::size_t end = 0; end < 2; ++end) {
      const double f = e.length * (mean / 2 + (end == 0 ? -slope : slope) / 12);
      to[e.corners[end]][0] += f * e.right[0], to[e.corners[end]][1] += f * e.right[1];
    }
  };
  for (const Edge& e : edges) {
    add(e, e.mean, e.slope, force);
    for (const std::size_t c : e.corners) inertia[c] += little * e.length / 4;
  }
  const auto product = [&](const Moves& x, Moves& y) {
    for (std::size_t k = 0; k < corners; ++k) y[k] = {inertia[k] * x[k][0], inertia[k] * x[k][1]};
    for (const Edge& e : edges) {
      const auto along = [&](std::size_t end) {
        return e.right[0] * x[e.corners[end]][0] + e.right[1] * x[e.corners[end]][1];
      };
      add(e, (along(0) + along(1)) / 2, along(1) - along(0), y);
    }
  };
  Moves x(corners, Point2{}), r = force, p(corners), z(corners), q(corners);
  const auto precondition = [&] {
    for (std::size_t k = 0; k < corners; ++k) z[k] = {r[k][0] / inertia[k], r[k][1] / inertia[k]};
  };
  precondition();
  p = z;
  double rz = dot(r, z);
  const double enough = 1e-12 * rz;
  constexpr int most = 500;
  for (int k = 0; k < most && rz > enough && rz > 0; ++k) {
    product(p, q);
    const double step = rz / dot(p, q);
    for (std::size_t c = 0; c < corners; ++c)
      for (std::size_t axis = 0; axis < 2; ++axis)
        x[c][axis] += step * p[c][axis], r[c][axis] -= step * q[c][axis];
    precondition();
    const double next = dot(r, z), ratio = next / rz;
    rz = next;
    for (std::size_t c = 0; c < corners; ++c)
      p[c] = {z[c][0] + ratio * p[c][0], z[c][1] + ratio * p[c][1]};
  }
  return x;
}

}  // namespace

double signed_area(const Ring& ring) {
  // Relative to a corner: far from the origin the products would lose digits.
  const Point2 o = ring.empty() ? Point2{} : ring.front();
  double sum = 0;
  for (std::size_t k = 1; k + 1 < ring.size(); ++k)
    sum += (ring[k][0] - o[0]) * (ring[k + 1][1] - o[1]) -
           (ring[k + 1][0] - o[0]) * (ring[k][1] - o[1]);
  return sum / 2;
}

void restore_areas(const std::vector<SimplifiedRing>& rings) {
  std::map<Point2, std::size_t> number;
  std::vector<std::vector<std::size_t>> corners_of;
  std::vector<Edge> edges;
  bool any = false;
  for (const auto& [given, fewer, area] : rings) {
    auto& corners = corners_of.emplace_back();
    for (const Point2& p : *fewer)
      corners.push_back(number.try_emplace(p, number.size()).first->second);
    any = any || given->size() != fewer->size() || area != signed_area(*fewer);
    each_chain(*given, *fewer, [&](std::size_t k, std::span<const Point2> chain) {
      const EdgeFrame frame(chain.front(), chain.back());
      Edge& edge = edges.emplace_back();
      edge.corners = {corners[k], corners[(k + 1) % corners.size()]};
      edge.right = frame.right(), edge.length = frame.length;
      if (chain.size() > 2) measure(chain, edge);
    });
  }
  if (!any) return;
  const Moves moves = fitted(edges, number.size());
  std::vector<Point2> at(number.size());
  for (const auto& [p, k] : number) at[k] = {p[0] + moves[k][0], p[1] + moves[k][1]};
  // What of the areas is still missing, ring by ring: corners move along the normals of the lines
  // between their neighbours.
  constexpr int sweeps = 200;
  constexpr double enough = 1e-13;
  bool moved = true;
  for (int sweep = 0; sweep < sweeps && moved; ++sweep) {
    moved = false;
    for (std::size_t r = 0; r < rings.size(); ++r) {
      Ring& ring = *rings[r].fewer;
      const std::size_t n = ring.size();
      for (std::size_t k = 0; k < n; ++k) ring[k] = at[corners_of[r][k]];
      const double missing = rings[r].area - signed_area(ring);
      if (std::abs(missing) <= enough * std::abs(rings[r].area)) continue;
      moved = true;
      double chords = 0;
      std::vector<Point2> normals;
      for (std::size_t k = 0; k < n; ++k) {
        const Point2 &before = ring[(k + n - 1) % n], &after = ring[(k + 1) % n];
        const double x = after[0] - before[0], y = after[1] - before[1], c = std::hypot(x, y);
        chords += c / 2;
        normals.push_back(c > 0 ? Point2{y / c, -x / c} : Point2{});
      }
      const double d = missing / chords;
      for (std::size_t k = 0; k < n; ++k)
        for (std::size_t axis = 0; axis < 2; ++axis)
          at[corners_of[r][k]][axis] += d * normals[k][axis];
    }
  }
  for (std::size_t r = 0; r < rings.size(); ++r)
    for (std::size_t k = 0; k < rings[r].fewer->size(); ++k)
      (*rings[r].fewer)[k] = at[corners_of[r][k]];
}

double largest_deviation(const SimplifiedRing& ring, const Ring& before) {
  double most = 0;
  each_chain(*ring.given, before, [&](std::size_t k, std::span<const Point2> chain) {
    const Ring& now = *ring.fewer;
    const EdgeFrame frame(now[k], now[(k + 1) % now.size()]);
    for (const Point2& p : chain) {
      const auto [t, s] = frame.local(p);
      most = std::max(most, std::hypot(t - std::clamp(t, 0.0, frame.length), s));
    }
  });
  return most;
}

double area_between(const SimplifiedRing& ring, const Ring& before) {
  double sum = 0;
  each_chain(*ring.given, before, [&](std::size_t k, std::span<const Point2> chain) {
    const Ring& now = *ring.fewer;
    const EdgeFrame frame(now[k], now[(k + 1) % now.size()]);
    double part = 0;  // of the lobe on this side of the edge
    Point2 last = frame.local(chain.front());
    for (const Point2& p : chain.subspan(1)) {
      const Point2 next = frame.local(p);
      if (last[1] * next[1] < 0) {
        const double s = last[0] + (next[0] - last[0]) * last[1] / (last[1] - next[1]);
        sum += std::abs(part + (s - last[0]) * last[1] / 2);
        part = (next[0] - s) * next[1] / 2;
      } else {
        part += (next[0] - last[0]) * (last[1] + next[1]) / 2;
      }
      last = next;
    }
    sum += std::abs(part);
  });
  return sum;
}

}  // namespace floe::mesh
