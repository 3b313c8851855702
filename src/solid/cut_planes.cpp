#include "solid/cut_planes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <utility>

#include "floe/base/item.h"
#include "solid/predicates.h"

namespace floe {
namespace {

/// An edge at which the piece is not convex.
struct Reflex {
  std::int32_t from = 0, to = 0;
  std::vector<std::int32_t> planes;  ///< of the triangles at the edge
  double length = 0, depth = 0;      ///< depth of its middle below the hull [m]
};

class Finder {
 public:
  Finder(const Piece& piece, const std::vector<HalfSpace>& planes, const Surface& hull,
         bool through_edges, double rounding)
      : piece_(piece), planes_(planes), through_edges_(through_edges), rounding_(rounding) {
    find_edges();
    find_depths(hull);
  }

  std::vector<CutPlane> planes() {
    propose();
    std::vector<CutPlane> found;
    for (const HalfSpace& plane : proposed_) {
      if (auto cut = weigh(plane)) found.push_back(*cut);
    }
    // The sort is that of a choice repeated among those that are left.
    std::vector<CutPlane> sorted;
    while (!found.empty()) {
      const auto best = choose(found);
      sorted.push_back(*best);
      found.erase(best);
    }
    return sorted;
  }

 private:
  const Point3& at(std::int32_t v) const { return item(piece_.surface.vertices, v); }

  void find_edges() {
    struct Use {
      std::int32_t from, to, triangle;
      bool forth;
    };
    std::vector<Use> uses;
    const auto& triangles = piece_.surface.triangles;
    for (std::int32_t t = 0; t < static_cast<std::int32_t>(triangles.size()); ++t) {
      for (std::size_t k = 0; k < 3; ++k) {
        const std::int32_t a = item(triangles, t)[k], b = item(triangles, t)[(k + 1) % 3];
        uses.push_back({std::min(a, b), std::max(a, b), t, a < b});
      }
    }
    const auto key = [](const Use& u) { return std::array{u.from, u.to, u.triangle}; };
    std::sort(uses.begin(), uses.end(),
              [&](const Use& one, const Use& other) { return key(one) < key(other); });
    for (std::size_t begin = 0, end = 0; begin < uses.size(); begin = end) {
      while (end < uses.size() && uses[end].from == uses[begin].from &&
             uses[end].to == uses[begin].to)
        ++end;
      const Use& first = uses[begin];
      edges_.push_back({first.from, first.to});
      const Point3 along = at(first.to) - at(first.from);
      const double size = length(along);
      if (!(size > rounding_)) continue;
      bool reflex = end - begin > 2;  // solids that touch along an edge
      if (end - begin == 2 && first.forth != uses[begin + 1].forth) {
        const Use& left = first.forth ? first : uses[begin + 1];
        const Use& right = first.forth ? uses[begin + 1] : first;
        constexpr double least = 1e-9;  // sine of the angle
        reflex = dot(cross(normal(left.triangle), normal(right.triangle)), along) < -least * size;
      }
      if (!reflex) continue;
      Reflex edge{first.from, first.to, {}, size, 0};
      for (std::size_t k = begin; k < end; ++k)
        edge.planes.push_back(item(piece_.plane, uses[k].triangle));
      reflex_.push_back(std::move(edge));
      all_reflex_ += size;
    }
  }
  const Point3& normal(std::int32_t t) const { return item(planes_, item(piece_.plane, t)).normal; }

  void find_depths(const Surface& hull) {
    std::vector<HalfSpace> sides;
    for (const auto& [a, b, c] : hull.triangles) {
      const Point3 o = item(hull.vertices, a);
      const Point3 n = cross(item(hull.vertices, b) - o, item(hull.vertices, c) - o);
      const double size = length(n);
      if (size > 0) sides.push_back({(1 / size) * n, dot((1 / size) * n, o)});
    }
    for (Reflex& edge : reflex_) {
      const Point3 middle = 0.5 * (at(edge.from) + at(edge.to));
      edge.depth = std::numeric_limits<double>::infinity();
      for (const HalfSpace& side : sides)
        edge.depth = std::min(edge.depth, side.offset - dot(side.normal, middle));
    }
    std::stable_sort(reflex_.begin(), reflex_.end(), [](const Reflex& one, const Reflex& other) {
      return one.length * one.depth > other.length * other.depth;
    });
  }

  /// Proposes planes at the most important reflex edges, of neighbours only one, and others.
  void propose() {
    constexpr std::size_t most_edges = 10;
    constexpr double apart = 0.1;  // over the size of the piece
    Point3 low = at(0), high = at(0);
    for (const Point3& p : piece_.surface.vertices) {
      for (std::size_t i = 0; i < 3; ++i) {
        low[i] = std::min(low[i], p[i]);
        high[i] = std::max(high[i], p[i]);
      }
    }
    size_ = length(high - low);
    std::vector<const Reflex*> chosen;
    const auto take = [&](bool others) {
      for (const Reflex& edge : reflex_) {
        if (chosen.size() >= most_edges) return;
        const auto near = [&](const Reflex* other) {
          if (others) return other == &edge;
          const Point3 between =
              0.5 * (at(edge.from) + at(edge.to)) - 0.5 * (at(other->from) + at(other->to));
          return length(between) < apart * size_;
        };
        if (std::none_of(chosen.begin(), chosen.end(), near)) chosen.push_back(&edge);
      }
    };
    take(false);
    take(true);
    for (const Reflex* edge : chosen) {
      const Point3& point = at(edge->from);
      for (const std::int32_t p : edge->planes) add(item(planes_, p).normal, point, edge);
      const Point3 across =
          item(planes_, edge->planes[0]).normal - item(planes_, edge->planes[1]).normal;
      if (length(across) > 1e-6) add((1 / length(across)) * across, point, edge);
      for (const Point3& axis : axes) add(axis, point, edge);
    }
    if (through_edges_) return;
    for (const double share : {0.5, 0.25, 0.75}) {
      for (const Point3& axis : axes) add(axis, low + share * (high - low), nullptr);
    }
  }
  void add(const Point3& normal, const Point3& point, const Reflex* edge) {
    const HalfSpace plane{normal, dot(normal, point)};
    if (through_edges_ && edge != nullptr && !holds(plane, *edge)) return;
    const auto same = [&](const HalfSpace& other) {
      const double side = dot(other.normal, normal) < 0 ? -1 : 1;
      return length(other.normal - side * normal) < 1e-12 &&
             std::abs(other.offset - side * plane.offset) <= rounding_;
    };
    if (std::none_of(proposed_.begin(), proposed_.end(), same)) proposed_.push_back(plane);
  }
  bool holds(const HalfSpace& plane, const Reflex& edge) const {
    return std::abs(dot(plane.normal, at(edge.from)) - plane.offset) <= rounding_ &&
           std::abs(dot(plane.normal, at(edge.to)) - plane.offset) <= rounding_;
  }

  /// Returns what a cut by a plane does; nothing if it does not cut the piece.
  std::optional<CutPlane> weigh(const HalfSpace& plane) {
    distance_.clear();
    below_.clear();
    above_.clear();
    bool any_below = false, any_above = false;
    for (const Point3& p : piece_.surface.vertices) {
      const double d = dot(plane.normal, p) - plane.offset;
      distance_.push_back(d);
      if (d < -rounding_) below_.push_back(p);
      if (d > rounding_) above_.push_back(p);
      any_below |= d < -rounding_;
      any_above |= d > rounding_;
    }
    if (!any_below || !any_above) return {};
    // A vertex in the plane belongs to the sides to which its edges lead.
    std::vector<bool> in_below(distance_.size()), in_above(distance_.size());
    for (const auto& [a, b] : edges_) {
      const double da = item(distance_, a), db = item(distance_, b);
      if (std::abs(da) <= rounding_ || std::abs(db) <= rounding_) {
        const std::int32_t on = std::abs(da) <= rounding_ ? a : b;
        const double other = on == a ? db : da;
        if (std::abs(other) <= rounding_) continue;
        auto& seen = other < 0 ? in_below : in_above;
        if (!seen[static_cast<std::size_t>(on)]) (other < 0 ? below_ : above_).push_back(at(on));
        seen[static_cast<std::size_t>(on)] = true;
        continue;
      }
      if ((da < 0) == (db < 0)) continue;
      const Point3 p = at(a) + (da / (da - db)) * (at(b) - at(a));
      below_.push_back(p);
      above_.push_back(p);
    }
    shake(below_);
    shake(above_);
    CutPlane cut{plane, volume_of(convex_hull(below_)) + volume_of(convex_hull(above_)), 0};
    for (const Reflex& edge : reflex_)
      if (holds(plane, edge)) cut.resolved += edge.length / all_reflex_;
    return cut;
  }

  /// Moves points by a millionth of the piece, alike on every machine: where four of them lie in
  /// one plane, exact predicates take most of the time, and volumes need not be exact here.
  void shake(std::vector<Point3>& points) const {
    std::uint32_t random = 1;
    for (Point3& p : points) {
      for (std::size_t i = 0; i < 3; ++i) {
        random = 1664525U * random + 1013904223U;  // Numerical Recipes, 3rd ed., section 7.1
        p[i] += 1e-6 * size_ * (static_cast<double>(random) / 4294967296.0 - 0.5);
      }
    }
  }

  std::vector<CutPlane>::iterator choose(std::vector<CutPlane>& cuts) const {
    constexpr double nearly = 1e-3, rounding = 1e-4;
    double least = std::numeric_limits<double>::infinity();
    for (const CutPlane& cut : cuts) least = std::min(least, cut.hulls);
    auto best = cuts.end();
    for (auto cut = cuts.begin(); cut != cuts.end(); ++cut) {
      if (cut->hulls > (1 + nearly) * least) continue;
      if (best == cuts.end() || cut->resolved > best->resolved + rounding ||
          (cut->resolved > best->resolved - rounding && cut->hulls < (1 - rounding) * best->hulls))
        best = cut;
    }
    return best;
  }

  static constexpr std::array<Point3, 3> axes{{Point3{1, 0, 0}, Point3{0, 1, 0}, Point3{0, 0, 1}}};

  const Piece& piece_;
  const std::vector<HalfSpace>& planes_;
  bool through_edges_;
  double rounding_;
  double size_ = 0;  ///< of the piece [m]
  std::vector<std::array<std::int32_t, 2>> edges_;
  std::vector<Reflex> reflex_;
  double all_reflex_ = 0;  ///< length of all reflex edges [m]
  std::vector<HalfSpace> proposed_;
  std::vector<double> distance_;
  std::vector<Point3> below_, above_;
};

}  // namespace

std::vector<CutPlane> cut_planes(const Piece& piece, const std::vector<HalfSpace>& planes,
                                 const Surface& hull, bool through_edges, double rounding) {
  return Finder(piece, planes, hull, through_edges, rounding).planes();
}

}  // namespace floe
