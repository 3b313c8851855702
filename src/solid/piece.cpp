#include "solid/piece.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <utility>

#include "base/union_find.h"
#include "floe/base/item.h"
#include "solid/predicates.h"

namespace floe {
namespace {

using Edge = std::array<std::int32_t, 2>;
using Triangle = Surface::Triangle;

Edge undirected(std::int32_t a, std::int32_t b) { return {std::min(a, b), std::max(a, b)}; }

/// Cuts one piece.
class Cutter {
 public:
  Cutter(const Piece& piece, const std::vector<HalfSpace>& planes, std::int32_t cut,
         double rounding)
      : piece_(piece), planes_(planes), cut_(cut), points_(piece.surface.vertices) {
    const HalfSpace& plane = item(planes, cut);
    for (const Point3& p : points_) {
      const double d = dot(plane.normal, p) - plane.offset;
      distance_.push_back(std::abs(d) <= rounding ? 0 : d);
    }
  }

  std::optional<Halves> halves() {
    const auto is = [&](auto sign) {
      return std::any_of(distance_.begin(), distance_.end(), sign);
    };
    if (!is([](double d) { return d < 0; }) || !is([](double d) { return d > 0; })) return {};
    for (std::int32_t t = 0; t < static_cast<std::int32_t>(piece_.plane.size()); ++t) divide(t);
    if (!close()) return {};
    return Halves{compact(below_), compact(above_)};
  }

 private:
  double distance(std::int32_t v) const { return item(distance_, v); }
  static void put(Piece& half, const Triangle& corners, std::int32_t plane) {
    half.surface.triangles.push_back(corners);
    half.plane.push_back(plane);
  }

  /// Gives a triangle, or its parts, to the halves.
  void divide(std::int32_t t) {
    const Triangle& corners = item(piece_.surface.triangles, t);
    const std::int32_t plane = item(piece_.plane, t);
    bool any_below = false, any_above = false;
    for (const std::int32_t v : corners) {
      any_below |= distance(v) < 0;
      any_above |= distance(v) > 0;
    }
    if (any_below && any_above) {
      put_part(below_, corners, plane, -1);
      put_part(above_, corners, plane, 1);
    } else if (any_below || any_above) {
      put(any_below ? below_ : above_, corners, plane);
    } else {  // in the plane: the solid is on the side against its normal
      const bool along = dot(item(planes_, plane).normal, item(planes_, cut_).normal) > 0;
      put(along ? below_ : above_, corners, plane);
    }
  }
  /// Adds the part of a triangle on one side: 1 above, -1 below.
  void put_part(Piece& half, const Triangle& corners, std::int32_t plane, int side) {
    std::array<std::int32_t, 4> polygon{};
    std::size_t n = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::int32_t a = corners[k], b = corners[(k + 1) % 3];
      const double da = side * distance(a), db = side * distance(b);
      if (da >= 0) polygon[n++] = a;
      if (da * db < 0) polygon[n++] = crossing(a, b);
    }
    put(half, {polygon[0], polygon[1], polygon[2]}, plane);
    if (n == 4) put(half, {polygon[0], polygon[2], polygon[3]}, plane);
  }
  /// Returns the vertex in which an edge crosses the plane.
  std::int32_t crossing(std::int32_t v, std::int32_t w) {
    const Edge edge = undirected(v, w);
    const auto [found, is_new] =
        crossings_.emplace(edge, static_cast<std::int32_t>(points_.size()));
    if (is_new) {
      const auto [a, b] = edge;
      const double t = distance(a) / (distance(a) - distance(b));
      const Point3 p = item(points_, a), q = item(points_, b);
      points_.push_back(p + t * (q - p));
    }
    return found->second;
  }
  bool is_in_plane(std::int32_t v) const {
    return static_cast<std::size_t>(v) >= distance_.size() || distance(v) == 0;
  }

  /// Adds the triangles in the plane. Returns false if that cannot be done.
  bool close() {
    std::map<Edge, int> net;
    for (const Triangle& corners : below_.surface.triangles) {
      for (std::size_t k = 0; k < 3; ++k) {
        const std::int32_t a = corners[k], b = corners[(k + 1) % 3];
        net[undirected(a, b)] += a < b ? 1 : -1;
      }
    }
    std::map<std::int32_t, std::int32_t> index;
    std::vector<std::int32_t> vertices;
    const auto local = [&](std::int32_t v) {
      const auto [found, is_new] = index.emplace(v, static_cast<std::int32_t>(vertices.size()));
      if (is_new) vertices.push_back(v);
      return found->second;
    };
    std::vector<Edge> edges;  // of the triangles to come: against those that are there
    for (const auto& [edge, times] : net) {
      if (times == 0) continue;
      const auto [a, b] = edge;
      if (!is_in_plane(a) || !is_in_plane(b)) return false;
      for (int k = 0; k < std::abs(times); ++k) {
        if (times > 0) {
          edges.push_back({local(b), local(a)});
        } else {
          edges.push_back({local(a), local(b)});
        }
      }
    }
    if (edges.empty()) return true;

    const Point3& normal = item(planes_, cut_).normal;
    std::size_t axis = 0;
    for (std::size_t i = 1; i < 3; ++i)
      if (std::abs(normal[i]) > std::abs(normal[axis])) axis = i;
    std::vector<Point2> points;
    for (const std::int32_t v : vertices) {
      const Point3& p = item(points_, v);
      const double one = p[(axis + 1) % 3], two = p[(axis + 2) % 3];
      points.push_back(normal[axis] > 0 ? Point2{one, two} : Point2{two, one});
    }
    const auto filling = fill(points, edges);
    return filling && put_filling(*filling, points, vertices);
  }
  bool put_filling(const Filling& filling, const std::vector<Point2>& points,
                   const std::vector<std::int32_t>& vertices) {
    double whole = 0, wrong = 0;
    for (std::size_t k = 0; k < filling.triangles.size(); ++k) {
      auto [a, b, c] = filling.triangles[k];
      const auto [ax, ay] = item(points, a);
      const auto [bx, by] = item(points, b);
      const auto [cx, cy] = item(points, c);
      const double area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax);
      (filling.times[k] == 1 ? whole : wrong) += area;
      a = item(vertices, a), b = item(vertices, b), c = item(vertices, c);
      if (filling.times[k] < 0) std::swap(b, c);
      for (int m = 0; m < std::abs(filling.times[k]); ++m) {
        put(below_, {a, b, c}, cut_);
        put(above_, {a, c, b}, cut_ + 1);
      }
    }
    constexpr double by_rounding = 1e-9;
    return wrong <= by_rounding * whole;
  }

  /// Returns a half with the vertices that it needs.
  Piece compact(Piece& half) const {
    std::vector<std::int32_t> index(points_.size(), -1);
    for (Triangle& corners : half.surface.triangles) {
      for (std::int32_t& v : corners) {
        std::int32_t& to = item(index, v);
        if (to < 0) {
          to = static_cast<std::int32_t>(half.surface.vertices.size());
          half.surface.vertices.push_back(item(points_, v));
        }
        v = to;
      }
    }
    return std::move(half);
  }

  const Piece& piece_;
  const std::vector<HalfSpace>& planes_;
  std::int32_t cut_;
  std::vector<Point3> points_;
  std::vector<double> distance_;
  std::map<Edge, std::int32_t> crossings_;
  Piece below_, above_;
};

}  // namespace

std::optional<Halves> cut(const Piece& piece, const std::vector<HalfSpace>& planes,
                          std::int32_t cut, double rounding) {
  return Cutter(piece, planes, cut, rounding).halves();
}

std::vector<Piece> connected_parts(const Piece& piece) {
  const auto& triangles = piece.surface.triangles;
  std::map<Edge, std::int32_t> first;
  UnionFind sets(triangles.size());
  for (std::int32_t t = 0; t < static_cast<std::int32_t>(triangles.size()); ++t) {
    const Triangle& corners = item(triangles, t);
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [found, is_new] = first.emplace(undirected(corners[k], corners[(k + 1) % 3]), t);
      if (!is_new) sets.unite(found->second, t);
    }
  }
  std::map<std::int32_t, std::size_t> part_of;
  std::vector<Piece> parts;
  std::vector<std::map<std::int32_t, std::int32_t>> index;
  for (std::int32_t t = 0; t < static_cast<std::int32_t>(triangles.size()); ++t) {
    const auto [found, is_new] = part_of.emplace(sets.find(t), parts.size());
    if (is_new) {
      parts.emplace_back();
      index.emplace_back();
    }
    Piece& part = parts[found->second];
    Triangle corners = item(triangles, t);
    for (std::int32_t& v : corners) {
      const auto [to, unseen] =
          index[found->second].emplace(v, static_cast<std::int32_t>(part.surface.vertices.size()));
      if (unseen) part.surface.vertices.push_back(item(piece.surface.vertices, v));
      v = to->second;
    }
    part.surface.triangles.push_back(corners);
    part.plane.push_back(item(piece.plane, t));
  }
  return parts;
}

void append(Piece& piece, const Piece& other) {
  const auto first = static_cast<std::int32_t>(piece.surface.vertices.size());
  auto& [vertices, triangles, lines] = piece.surface;
  vertices.insert(vertices.end(), other.surface.vertices.begin(), other.surface.vertices.end());
  for (const auto& [a, b, c] : other.surface.triangles)
    triangles.push_back({a + first, b + first, c + first});
  piece.plane.insert(piece.plane.end(), other.plane.begin(), other.plane.end());
}

}  // namespace floe
