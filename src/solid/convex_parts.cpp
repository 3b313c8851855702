#include "solid/convex_parts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <span>
#include <utility>
#include <vector>

#include "base/union_find.h"
#include "floe/base/item.h"
#include "floe/base/petsc.h"
#include "floe/geometry/half_space.h"
#include "geometry/overlap.h"
#include "solid/coarse_hull.h"
#include "solid/cut_planes.h"
#include "solid/hull_distance.h"
#include "solid/piece.h"
#include "solid/polygon_faces.h"
#include "solid/predicates.h"

namespace floe {
namespace {

double area_of(const Surface& surface) {
  double sum = 0;
  for (const auto& [a, b, c] : surface.triangles) {
    const Point3& o = item(surface.vertices, a);
    sum += length(cross(item(surface.vertices, b) - o, item(surface.vertices, c) - o)) / 2;
  }
  return sum;
}

/// A piece and its convex hull.
struct Hulled {
  Piece piece;
  Surface hull;
};

class Divider {
 public:
  Divider(const Surface& surface, double tolerance, int most, std::string where)
      : tolerance_(tolerance), most_(most), where_(std::move(where)) {
    Point3 low = surface.vertices.front(), high = low;
    double largest = 0;
    for (const Point3& p : surface.vertices) {
      for (std::size_t i = 0; i < 3; ++i) {
        low[i] = std::min(low[i], p[i]);
        high[i] = std::max(high[i], p[i]);
        largest = std::max(largest, std::abs(p[i]));
      }
    }
    in_plane_ = 1e-11 * largest;
    of_file_ = 2.4e-7 * largest;
    of_faces_ = 1e-9 * length(high - low);
    parts_.triangles = static_cast<std::int64_t>(surface.triangles.size());
    parts_.volume = volume_of(surface);
    set_planes(surface);
  }

  ConvexParts parts() && {
    take(std::move(whole_));
    while (!todo_.empty()) {
      const Hulled next = std::move(todo_.back());
      todo_.pop_back();
      if (!accept(next)) divide(next);
    }
    for (std::int32_t b = 0; b < parts_.shapes.bodies(); ++b)
      parts_.parts_volume += volume_properties(parts_.shapes, b).volume;
    return std::move(parts_);
  }

 private:
  void set_planes(const Surface& surface) {
    whole_.surface.vertices = surface.vertices;
    whole_.surface.triangles = surface.triangles;
    for (const auto& [a, b, c] : surface.triangles) {
      const Point3& o = item(surface.vertices, a);
      Point3 n = cross(item(surface.vertices, b) - o, item(surface.vertices, c) - o);
      n = (1 / length(n)) * n;
      whole_.plane.push_back(static_cast<std::int32_t>(planes_.size()));
      planes_.push_back({n, dot(n, o)});
    }
  }

  /// Puts the connected parts of a piece on the list. Parts whose hulls overlap stay together: a
  /// cut has to divide them.
  void take(Piece&& piece) {
    std::vector<Hulled> all;
    for (Piece& part : connected_parts(piece)) {
      Surface hull = convex_hull(part.surface.vertices);
      // thinner than the rounding of the file
      if (2 * volume_of(hull) <= of_file_ * area_of(hull)) continue;
      all.push_back({std::move(part), std::move(hull)});
    }
    if (tolerance_ > of_file_) {
      while (join(all)) {
      }
    }
    for (auto one = all.rbegin(); one != all.rend(); ++one) todo_.push_back(std::move(*one));
    const auto least = static_cast<std::int64_t>(todo_.size()) + parts_.shapes.bodies();
    if (least > most_) {
      std::array<char, 32> text{};
      std::snprintf(text.data(), text.size(), "%g", tolerance_);
      throw InputError(where_ + ": needs more than " + std::to_string(most_) +
                       " convex parts at a tolerance of " + text.data() +
                       " m; a larger tolerance gives fewer");
    }
  }
  /// Joins pieces whose hulls overlap; false if there are none.
  bool join(std::vector<Hulled>& all) const {
    constexpr double by_rounding = 1e-12;
    Shapes shapes;
    for (const Hulled& one : all) append_hull(shapes, one.hull, of_faces_);
    UnionFind sets(all.size());
    Clipper clipper;
    bool any = false;
    for (std::int32_t a = 0; a < shapes.bodies(); ++a) {
      const std::span<const Point3> placed(shapes.vertices.data() + item(shapes.vertex_of, a),
                                           shapes.vertices.data() + item(shapes.vertex_of, a + 1));
      for (std::int32_t b = a + 1; b < shapes.bodies(); ++b) {
        std::vector<HalfSpace> planes;
        append_half_spaces(shapes, b, planes);
        const double volume = clipper.overlap(shapes, a, placed, planes).volume;
        if (!(volume > by_rounding * parts_.volume)) continue;
        sets.unite(a, b);
        any = true;
      }
    }
    if (!any) return false;
    std::vector<Hulled> joined;
    std::vector<std::int32_t> index(all.size(), -1);
    for (std::int32_t k = 0; k < static_cast<std::int32_t>(all.size()); ++k) {
      std::int32_t& to = item(index, sets.find(k));
      if (to < 0) {
        to = static_cast<std::int32_t>(joined.size());
        joined.push_back(std::move(item(all, k)));
      } else {
        append(item(joined, to).piece, item(all, k).piece);
      }
    }
    for (Hulled& one : joined) one.hull = convex_hull(one.piece.surface.vertices);
    all = std::move(joined);
    return true;
  }

  /// Makes a piece a part if its hull is near enough.
  bool accept(const Hulled& one) {
    if (!is_convex(one)) {
      if (tolerance_ <= of_file_) return false;
      const double found = hull_distance(one.hull, one.piece.surface, tolerance_, of_faces_);
      if (found > tolerance_) return false;
      parts_.distance = std::max(parts_.distance, found);
    }
    append_hull(parts_.shapes, tolerance_ > of_file_ ? coarse(one) : one.hull, of_faces_);
    return true;
  }
  /// Returns the hull of a piece with no more vertices than the tolerance asks for.
  Surface coarse(const Hulled& one) {
    std::vector<HalfSpace> cuts;
    for (const std::int32_t p : one.piece.plane)
      if (p >= parts_.triangles) cuts.push_back(item(planes_, p));
    double found = 0;
    Surface hull = coarse_hull(one.hull, cuts, tolerance_, of_faces_, found);
    parts_.distance = std::max(parts_.distance, found);
    return hull;
  }
  /// Whether every triangle of a piece bounds its hull.
  bool is_convex(const Hulled& one) const {
    std::vector<bool> seen(planes_.size(), false);
    for (const std::int32_t p : one.piece.plane) {
      if (seen[static_cast<std::size_t>(p)]) continue;
      seen[static_cast<std::size_t>(p)] = true;
      const HalfSpace& plane = item(planes_, p);
      for (const Point3& v : one.hull.vertices)
        if (dot(plane.normal, v) - plane.offset > of_file_) return false;
    }
    return true;
  }

  void divide(const Hulled& one) {
    const double volume = volume_of(one.piece.surface);
    const bool exact = tolerance_ <= of_file_;
    for (const CutPlane& best : cut_planes(one.piece, planes_, one.hull, exact, in_plane_)) {
      const auto index = static_cast<std::int32_t>(planes_.size());
      planes_.push_back(best.plane);
      planes_.push_back({-best.plane.normal, -best.plane.offset});
      if (auto halves = cut(one.piece, planes_, index, in_plane_)) {
        constexpr double by_rounding = 1e-10;
        const double both = volume_of(halves->below.surface) + volume_of(halves->above.surface);
        if (std::abs(both - volume) <= by_rounding * parts_.volume) {
          Piece below = std::move(halves->below);
          take(std::move(halves->above));
          take(std::move(below));
          return;
        }
      }
      planes_.resize(planes_.size() - 2);
    }
    const Point3& at = one.piece.surface.vertices.front();
    std::array<char, 128> text{};
    std::snprintf(text.data(), text.size(), "(%.6g, %.6g, %.6g) m", at.x, at.y, at.z);
    throw InputError(where_ + ": cannot be divided into convex parts near " + text.data() +
                     " by rounding; a larger tolerance may do");
  }

  double tolerance_;
  int most_;
  std::string where_;
  double in_plane_ = 0;  ///< distance from a plane that is rounding of our numbers [m]
  double of_file_ = 0;   ///< that is rounding of the file's numbers [m]
  double of_faces_ = 0;  ///< that faces may have from their planes [m]
  Piece whole_;
  std::vector<HalfSpace> planes_;
  std::vector<Hulled> todo_;
  ConvexParts parts_;
};

}  // namespace

ConvexParts convex_parts(const Surface& surface, double tolerance, int most,
                         const std::string& where) {
  return Divider(surface, tolerance, most, where).parts();
}

}  // namespace floe
