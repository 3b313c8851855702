// What of an outline needs CGAL: whether its rings are polygons, and their simplification.
#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Constrained_triangulation_plus_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_2_algorithms.h>
#include <CGAL/Polyline_simplification_2/simplify.h>
#include <CGAL/Polyline_simplification_2/Squared_distance_cost.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "floe/geometry/polyhedron.h"
#include "floe/mesh/outline.h"
#include "mesh/outline_area.h"

namespace floe {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
namespace simplification = CGAL::Polyline_simplification_2;

Kernel::Point_2 cgal(const Point2& p) { return {p[0], p[1]}; }

/// Sign of the area of a triangle, exactly: 1 counter-clockwise, 0 on a line.
int turn(const Point2& a, const Point2& b, const Point2& c) {
  return static_cast<int>(CGAL::orientation(cgal(a), cgal(b), cgal(c)));
}

/// Whether two edges cross at a place that is an end of neither.
bool cross(const Point2& a, const Point2& b, const Point2& c, const Point2& d) {
  if (std::max(a[0], b[0]) < std::min(c[0], d[0]) || std::max(c[0], d[0]) < std::min(a[0], b[0]) ||
      std::max(a[1], b[1]) < std::min(c[1], d[1]) || std::max(c[1], d[1]) < std::min(a[1], b[1]))
    return false;
  return turn(a, b, c) * turn(a, b, d) < 0 && turn(c, d, a) * turn(c, d, b) < 0;
}

/// Formats the place of a point.
std::string place(const Point2& p) {
  std::array<char, 80> text{};
  std::snprintf(text.data(), text.size(), " near (%.6g, %.6g)", p[0], p[1]);
  return text.data();
}

/// Formats the place where two edges cross.
std::string place(const Point2& a, const Point2& b, const Point2& c, const Point2& d) {
  const double ex = b[0] - a[0], ey = b[1] - a[1], fx = d[0] - c[0], fy = d[1] - c[1];
  const double t = ((c[0] - a[0]) * fy - (c[1] - a[1]) * fx) / (ex * fy - ey * fx);
  return place({a[0] + t * ex, a[1] + t * ey});
}

/// Where a ring crosses itself; empty if it is too long for looking at all pairs of edges, or if it
/// only touches itself.
std::string self_crossing(const Ring& ring) {
  constexpr std::size_t longest = 20'000;
  const std::size_t n = ring.size();
  for (std::size_t i = 0; n <= longest && i + 2 < n; ++i) {
    for (std::size_t j = i + 2; j < n; ++j) {
      const Point2 &a = ring[i], &b = ring[i + 1], &c = ring[j], &d = ring[(j + 1) % n];
      if (cross(a, b, c, d)) return place(a, b, c, d);
    }
  }
  return {};
}

enum Where { outside = -1, on_it = 0, inside = 1 };

Where where(const Ring& ring, const Point2& p) {
  bool odd = false;
  for (std::size_t k = 0; k < ring.size(); ++k) {
    const Point2 &a = ring[k], &b = ring[(k + 1) % ring.size()];
    const bool within = std::min(a[0], b[0]) <= p[0] && p[0] <= std::max(a[0], b[0]) &&
                        std::min(a[1], b[1]) <= p[1] && p[1] <= std::max(a[1], b[1]);
    if (within && turn(a, b, p) == 0) return on_it;
    if ((a[1] > p[1]) != (b[1] > p[1]) && turn(a, b, p) * (b[1] > a[1] ? 1 : -1) > 0) odd = !odd;
  }
  return odd ? inside : outside;
}

Where where(const RingedPolygon& polygon, const Point2& p) {
  const Where in_outer = where(polygon.front(), p);
  for (std::size_t k = 1; k < polygon.size() && in_outer == inside; ++k) {
    const Where in_hole = where(polygon[k], p);
    if (in_hole != outside) return in_hole == on_it ? on_it : outside;
  }
  return in_outer;
}

bool are_apart(const PlanBox& a, const PlanBox& b) {
  return a.most[0] < b.least[0] || b.most[0] < a.least[0] || a.most[1] < b.least[1] ||
         b.most[1] < a.least[1];
}

/// A place where the edges of two rings cross; empty if there is none.
std::string crossing(const Ring& one, const Ring& other) {
  const PlanBox a = box_of({one}), b = box_of({other});
  const auto edges_in = [](const Ring& ring, const PlanBox& box) {
    std::vector<std::array<Point2, 2>> edges;
    for (std::size_t k = 0; k < ring.size(); ++k) {
      const Point2 &p = ring[k], &q = ring[(k + 1) % ring.size()];
      if (!are_apart(box, box_of({{p, q}}))) edges.push_back({p, q});
    }
    return edges;
  };
  const auto second = edges_in(other, a);
  for (const auto& [p, q] : edges_in(one, b))
    for (const auto& [r, s] : second)
      if (cross(p, q, r, s)) return place(p, q, r, s);
  return {};
}

std::string flaw_of_ring(const Ring& ring) {
  if (ring.size() < 3)
    return "has " + std::to_string(ring.size()) + " different corners; 3 or more make a polygon";
  std::vector<Kernel::Point_2> points;
  points.reserve(ring.size());
  for (const Point2& p : ring) points.push_back(cgal(p));
  if (!CGAL::is_simple_2(points.begin(), points.end(), Kernel())) {
    const std::string at = self_crossing(ring);
    return at.empty() ? "touches itself" : "crosses itself" + at;
  }
  return {};
}

/// Why the holes of a polygon are none; empty if they are.
std::string flaw_of_holes(const RingedPolygon& polygon, const std::string& name) {
  std::vector<PlanBox> boxes;
  for (const Ring& ring : polygon) boxes.push_back(box_of({ring}));
  for (std::size_t i = 1; i < polygon.size(); ++i) {
    const std::string hole = name + ", hole " + std::to_string(i);
    if (const std::string at = crossing(polygon.front(), polygon[i]); !at.empty())
      return hole + ": crosses the outer ring" + at;
    for (const Point2& p : polygon[i])
      if (where(polygon.front(), p) == outside) return hole + ": lies outside" + place(p);
    for (std::size_t j = 1; j < i; ++j) {
      if (are_apart(boxes[i], boxes[j])) continue;
      std::string at = crossing(polygon[i], polygon[j]);
      for (const auto& [one, other] : {std::pair{i, j}, std::pair{j, i}})
        for (const Point2& p : polygon[one])
          if (at.empty() && where(polygon[other], p) == inside) at = place(p);
      if (!at.empty()) return hole + ": overlaps hole " + std::to_string(j) + at;
    }
  }
  return {};
}

/// Whether two edges lie on each other over some length, in the same direction: then the ice to
/// their left does too.
bool go_together(const Point2& a, const Point2& b, const Point2& c, const Point2& d) {
  const Point2 e{b[0] - a[0], b[1] - a[1]}, f{d[0] - c[0], d[1] - c[1]};
  if (!(e[0] * f[0] + e[1] * f[1] > 0) || turn(a, b, c) != 0 || turn(a, b, d) != 0) return false;
  const std::size_t axis = std::abs(e[0]) > std::abs(e[1]) ? 0 : 1;
  const auto [low, high] = std::minmax(a[axis], b[axis]);
  const auto [from, to] = std::minmax(c[axis], d[axis]);
  return std::max(low, from) < std::min(high, to);
}

/// Whether a point lies in a polygon, by more than rounding.
bool is_deep_in(const RingedPolygon& polygon, const Point2& p) {
  const auto [least, most] = box_of(polygon);
  constexpr double rounding = 1e-9;
  return where(polygon, p) == inside &&
         Outline({polygon}).distance(p) > rounding * (most[0] - least[0] + most[1] - least[1]);
}

/// A place where edges of one polygon say that it overlaps another, though no edges cross and no
/// corner of the one is inside the other: empty if there is none.
std::string overlap_of_edges(const RingedPolygon& one, const RingedPolygon& other) {
  const PlanBox around = box_of(other);
  std::vector<std::array<Point2, 2>> edges;
  for (const Ring& ring : other)
    for (std::size_t k = 0; k < ring.size(); ++k)
      edges.push_back({ring[k], ring[(k + 1) % ring.size()]});
  for (const Ring& ring : one) {
    for (std::size_t k = 0; k < ring.size(); ++k) {
      const Point2 &a = ring[k], &b = ring[(k + 1) % ring.size()];
      if (are_apart(around, box_of({{a, b}}))) continue;
      const Point2 middle{(a[0] + b[0]) / 2, (a[1] + b[1]) / 2};
      const bool together = std::any_of(edges.begin(), edges.end(), [&](const auto& edge) {
        return go_together(a, b, edge[0], edge[1]);
      });
      if (together || is_deep_in(other, middle)) return place(middle);
    }
  }
  return {};
}

/// Where two polygons overlap; empty if they do not.
std::string overlap(const RingedPolygon& a, const RingedPolygon& b) {
  if (are_apart(box_of(a), box_of(b))) return {};
  for (const Ring& r : a)
    for (const Ring& s : b)
      if (const std::string at = crossing(r, s); !at.empty()) return at;
  for (const auto& [one, other] : {std::pair{&a, &b}, std::pair{&b, &a}})
    for (const Point2& p : one->front())
      if (where(*other, p) == inside) return place(p);
  std::string at = overlap_of_edges(a, b);
  return at.empty() ? overlap_of_edges(b, a) : at;
}

/// Moves each edge of a ring to its left, where the ice is, by a distance that is small beside the
/// edges [m].
Ring moved_inwards(const Ring& ring, double distance) {
  const std::size_t n = ring.size();
  const auto normal = [&](std::size_t k) {
    const Point2 &a = ring[k % n], &b = ring[(k + 1) % n];
    const double length = std::hypot(b[0] - a[0], b[1] - a[1]);
    return Point2{(a[1] - b[1]) / length, (b[0] - a[0]) / length};
  };
  Ring result;
  for (std::size_t k = 0; k < n; ++k) {
    const Point2 before = normal(k + n - 1), after = normal(k);
    constexpr double sharpest = 0.01;  // a sharper corner moves less far than its edges
    const double d = distance / std::max(1 + before[0] * after[0] + before[1] * after[1], sharpest);
    result.push_back(
        {ring[k][0] + d * (before[0] + after[0]), ring[k][1] + d * (before[1] + after[1])});
  }
  return result;
}

}  // namespace

std::string Outline::flaw() const {
  for (std::size_t k = 0; k < polygons_.size(); ++k) {
    for (std::size_t r = 0; r < polygons_[k].size(); ++r)
      if (const std::string why = flaw_of_ring(polygons_[k][r]); !why.empty())
        return name_of_ring(*this, k, r) + ": " + why;
    std::string why = flaw_of_holes(polygons_[k], name_of_ring(*this, k, 0));
    if (!why.empty()) return why;
  }
  const std::vector<OverlappingPolygons> pair = find_overlaps(polygons_, 0, 1);
  if (pair.empty()) return {};
  return name_of_ring(*this, pair.front().first, 0) + " and polygon " +
         std::to_string(pair.front().second + 1) + ": overlap" + pair.front().place;
}

std::vector<OverlappingPolygons> find_overlaps(const std::vector<RingedPolygon>& given,
                                               double slack, std::size_t most) {
  std::vector<OverlappingPolygons> found;
  std::vector<RingedPolygon> polygons = given;
  if (slack > 0)
    for (RingedPolygon& polygon : polygons)
      for (Ring& ring : polygon) ring = moved_inwards(ring, slack / 2);
  // From left to right, so that only polygons that overlap in x are compared.
  std::vector<std::size_t> order(polygons.size());
  for (std::size_t k = 0; k < order.size(); ++k) order[k] = k;
  std::vector<PlanBox> boxes;
  for (const RingedPolygon& polygon : polygons) boxes.push_back(box_of(polygon));
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return boxes[a].least < boxes[b].least; });
  for (std::size_t i = 0; i < order.size(); ++i) {
    for (std::size_t j = i + 1; j < order.size(); ++j) {
      const auto [a, b] = std::minmax(order[i], order[j]);
      if (boxes[order[j]].least[0] > boxes[order[i]].most[0]) break;
      if (std::string at = overlap(polygons[a], polygons[b]); !at.empty())
        found.push_back({a, b, std::move(at)});
      if (found.size() == most) return found;
    }
  }
  return found;
}

namespace {

using Triangulation =
    CGAL::Constrained_triangulation_plus_2<CGAL::Constrained_Delaunay_triangulation_2<
        Kernel,
        CGAL::Triangulation_data_structure_2<simplification::Vertex_base_2<Kernel>,
                                             CGAL::Constrained_triangulation_face_base_2<Kernel>>,
        CGAL::Exact_predicates_tag>>;

/// The corner that is farthest from the middle, which stays: a ring's first corner is not taken
/// out.
std::size_t farthest(const Ring& ring) {
  Point2 middle{};
  for (const Point2& p : ring)
    middle[0] += p[0] / static_cast<double>(ring.size()),
        middle[1] += p[1] / static_cast<double>(ring.size());
  const auto away = [&](const Point2& p) { return std::hypot(p[0] - middle[0], p[1] - middle[1]); };
  const auto most =
      std::max_element(ring.begin(), ring.end(),
                       [&](const Point2& p, const Point2& q) { return away(p) < away(q); });
  return static_cast<std::size_t>(most - ring.begin());
}

/// Simplifies an outline by CGAL.
/// \param given  set to its polygons, with corners where they touch and without holes that are
///   filled; those of the result are some of their corners, in the same order from the same first
/// \param filled  set to the area of the holes of each polygon that are filled [m^2]
std::vector<RingedPolygon> taken_out(const Outline& outline, double tolerance,
                                     std::vector<RingedPolygon>& given,
                                     std::vector<double>& filled) {
  Triangulation triangulation;
  std::vector<std::vector<Triangulation::Constraint_id>> constraints;
  filled.assign(outline.polygons().size(), 0.0);
  for (const RingedPolygon& polygon : outline.polygons()) {
    constraints.emplace_back();
    for (const Ring& ring : polygon) {
      const double area = std::abs(mesh::signed_area(ring));
      if (&ring != &polygon.front() && area < tolerance * tolerance) {
        filled[constraints.size() - 1] += area;
        continue;
      }
      std::vector<Kernel::Point_2> points;
      for (std::size_t k = 0, first = farthest(ring); k < ring.size(); ++k)
        points.push_back(cgal(ring[(first + k) % ring.size()]));
      constexpr bool closed = true;
      constraints.back().push_back(
          triangulation.insert_constraint(points.begin(), points.end(), closed));
    }
  }
  // Where polygons touch, corners of one lie on edges of the other.
  const auto rings = [&] {
    std::vector<RingedPolygon> polygons;
    for (const auto& of_polygon : constraints) {
      polygons.emplace_back();
      for (const auto& constraint : of_polygon) {
        Ring& ring = polygons.back().emplace_back();
        for (auto v = triangulation.vertices_in_constraint_begin(constraint);
             v != triangulation.vertices_in_constraint_end(constraint); ++v)
          ring.push_back({(*v)->point().x(), (*v)->point().y()});
        ring.pop_back();  // the first once more
      }
    }
    return polygons;
  };
  given = rings();
  simplification::simplify(triangulation, simplification::Squared_distance_cost(),
                           simplification::Stop_above_cost_threshold(tolerance * tolerance));
  std::vector<RingedPolygon> polygons = rings();
  for (std::size_t k = 0; k < given.size(); ++k)
    for (std::size_t r = 0; r < given[k].size(); ++r)
      if (polygons[k][r].size() < 3) polygons[k][r] = given[k][r];
  return polygons;
}

/// Takes corners out, and moves the others as the areas are to be kept. \return whether all lies
/// within `most` of the given outline, and is an outline
bool simplify(const Outline& outline, double tolerance, double most, Areas areas,
              SimplifiedOutline& result) {
  std::vector<RingedPolygon> given;
  std::vector<double> filled;
  std::vector<RingedPolygon> polygons = taken_out(outline, tolerance, given, filled);
  const std::vector<RingedPolygon> before = polygons;
  std::vector<mesh::SimplifiedRing> rings;
  for (std::size_t k = 0; k < given.size(); ++k)
    for (std::size_t r = 0; r < given[k].size(); ++r)
      rings.push_back({&given[k][r], &polygons[k][r],
                       mesh::signed_area(given[k][r]) + (r == 0 ? -filled[k] : 0)});
  if (areas == Areas::kept) mesh::restore_areas(rings);
  result.moved = 0;
  for (const double area : filled) result.moved += area;
  std::size_t next = 0;
  for (const RingedPolygon& polygon : before) {
    for (const Ring& ring : polygon) {
      const mesh::SimplifiedRing& now = rings[next++];
      result.moved += mesh::area_between(now, ring);
      if (areas == Areas::kept && mesh::largest_deviation(now, ring) > most) return false;
    }
  }
  result.outline = Outline(std::move(polygons));
  return areas != Areas::kept || result.outline.flaw().empty();
}

}  // namespace

SimplifiedOutline simplified(const Outline& outline, double tolerance, Areas areas) {
  if (tolerance == 0) return {outline, 0};
  SimplifiedOutline result;
  constexpr int tries = 10;
  double least = tolerance;  // fewer corners are taken out where the others would move too far
  for (int k = 0; k < tries; ++k, least *= 0.75)
    if (simplify(outline, least, tolerance, areas, result)) return result;
  return {outline, 0};
}

}  // namespace floe
