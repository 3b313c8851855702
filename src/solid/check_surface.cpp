#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <numbers>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "base/union_find.h"
#include "floe/base/item.h"
#include "floe/base/petsc.h"
#include "solid/predicates.h"
#include "solid/surface.h"

namespace floe {
namespace {

std::string text_of(double number) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.6g", number);
  return text.data();
}
std::string text_of(const Point3& p) {
  return "(" + text_of(p.x) + ", " + text_of(p.y) + ", " + text_of(p.z) + ")";
}

/// A closed shell: connected triangles.
struct Shell {
  std::vector<std::int32_t> triangles;
  Point3 low{}, high{};
  double volume = 0;  ///< [m^3]
};

class Checker {
 public:
  Checker(const Surface& surface, const std::string& where) : surface_(surface), where_(where) {}

  void check() {
    expect_areas();
    expect_closed();
    expect_apart();
    expect_outward();
  }

 private:
  [[noreturn]] void refuse(const std::string& why) const { throw InputError(where_ + ": " + why); }
  const Surface::Triangle& triangle(std::int32_t t) const { return item(surface_.triangles, t); }
  const Point3& vertex(std::int32_t v) const { return item(surface_.vertices, v); }
  Point3 corner(std::int32_t t, std::size_t k) const { return vertex(triangle(t)[k]); }
  Point3 middle(std::int32_t t) const {
    return (1.0 / 3) * (corner(t, 0) + corner(t, 1) + corner(t, 2));
  }
  /// Names a triangle by its number from 1 and, in a text file, its line.
  std::string name(std::int32_t t) const {
    std::string text = "triangle " + std::to_string(t + 1);
    if (!surface_.lines.empty()) text += " (line " + std::to_string(item(surface_.lines, t)) + ")";
    return text;
  }
  std::string edge(std::int32_t a, std::int32_t b) const {
    return "the edge from " + text_of(vertex(a)) + " to " + text_of(vertex(b)) + " m";
  }

  void expect_areas() const {
    constexpr double least = 1e-9;  // height over the longest side
    for (std::int32_t t = 0; t < static_cast<std::int32_t>(surface_.triangles.size()); ++t) {
      double longest2 = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        const Point3 side = corner(t, (k + 1) % 3) - corner(t, k);
        longest2 = std::max(longest2, dot(side, side));
      }
      const double area2 = length(cross(corner(t, 1) - corner(t, 0), corner(t, 2) - corner(t, 0)));
      if (!(area2 > least * longest2))
        refuse(
            name(t) + " at " + text_of(corner(t, 0)) +
            " m has no area; remove such triangles, e.g. by MeshLab's removal of zero area faces");
    }
  }

  /// Checks that every edge is in two triangles, once in each direction, and finds the shells.
  void expect_closed() {
    std::vector<std::array<std::int32_t, 4>> edges;  // smaller, larger vertex, triangle, direction
    for (std::int32_t t = 0; t < static_cast<std::int32_t>(surface_.triangles.size()); ++t) {
      for (std::size_t k = 0; k < 3; ++k) {
        const std::int32_t a = triangle(t)[k], b = triangle(t)[(k + 1) % 3];
        edges.push_back({std::min(a, b), std::max(a, b), t, a < b ? 0 : 1});
      }
    }
    std::sort(edges.begin(), edges.end());
    UnionFind connected(surface_.triangles.size());
    for (std::size_t begin = 0, end = 0; begin < edges.size(); begin = end) {
      while (end < edges.size() && edges[end][0] == edges[begin][0] &&
             edges[end][1] == edges[begin][1])
        ++end;
      const auto [a, b, t, direction] = edges[begin];
      if (end - begin == 1)
        refuse("the surface is open: " + edge(a, b) + " is in " + name(t) + " only");
      const std::int32_t other = edges[begin + 1][2];
      if (end - begin > 2)
        refuse(edge(a, b) + " is in " + std::to_string(end - begin) +
               " triangles, must be in two: " + name(t) + ", " + name(other) + ", " +
               name(edges[begin + 2][2]) + (end - begin > 3 ? ", ..." : ""));
      if (direction == edges[begin + 1][3])
        refuse(name(t) + " and " + name(other) + " are turned opposite ways, at " + edge(a, b) +
               "; all triangles must be counter-clockwise seen from outside");
      connected.unite(t, other);
    }
    const std::vector<std::int32_t> first = connected.representatives();
    std::vector<std::int32_t> shell_of(first.size(), -1);
    for (std::int32_t t = 0; t < static_cast<std::int32_t>(first.size()); ++t) {
      std::int32_t& shell = item(shell_of, item(first, t));
      if (shell < 0) {
        shell = static_cast<std::int32_t>(shells_.size());
        shells_.push_back({{}, corner(t, 0), corner(t, 0), 0});
      }
      add(t, item(shells_, shell));
    }
  }
  void add(std::int32_t t, Shell& shell) const {
    // about the shell's first corner
    const Point3 apex = shell.triangles.empty() ? corner(t, 0) : corner(shell.triangles.front(), 0);
    shell.triangles.push_back(t);
    shell.volume += dot(corner(t, 0) - apex, cross(corner(t, 1) - apex, corner(t, 2) - apex)) / 6;
    for (std::size_t k = 0; k < 3; ++k) {
      const Point3 p = corner(t, k);
      for (std::size_t i = 0; i < 3; ++i) {
        shell.low[i] = std::min(shell.low[i], p[i]);
        shell.high[i] = std::max(shell.high[i], p[i]);
      }
    }
  }

  void expect_apart() const {
    const auto pair = crossing_triangles(surface_);
    if (!pair) return;
    const auto [a, b] = *pair;
    const bool same = std::any_of(shells_.begin(), shells_.end(), [&](const Shell& s) {
      const auto has = [&](std::int32_t t) {
        return std::binary_search(s.triangles.begin(), s.triangles.end(), t);
      };
      return has(a) && has(b);
    });
    refuse(std::string(same ? "the surface intersects or touches itself: "
                            : "two closed surfaces of the file intersect or touch: ") +
           name(a) + " at " + text_of(middle(a)) + " m and " + name(b) + " at " +
           text_of(middle(b)) + " m");
  }

  void expect_outward() const {
    double volume = 0;
    for (const Shell& shell : shells_) volume += shell.volume;
    if (!(volume > 0))
      refuse("the surface is inside out: its volume is " + text_of(volume) +
             " m3; triangles must be counter-clockwise seen from outside: turn all of them, e.g. "
             "by Blender's Flip Normals or MeshLab's Invert Faces Orientation");
    for (const Shell& shell : shells_) {
      for (const Shell& other : shells_) {
        if (&shell == &other || !is_inside(corner(shell.triangles.front(), 0), other)) continue;
        refuse(std::string(shell.volume > 0 ? "a closed surface lies inside another, so that they "
                                              "overlap: "
                                            : "has a cavity, must be solid: ") +
               "that of " + name(shell.triangles.front()) + " at " +
               text_of(middle(shell.triangles.front())) + " m is inside that of " +
               name(other.triangles.front()));
      }
    }
    for (const Shell& shell : shells_) {
      if (!(shell.volume > 0))
        refuse("one of its " + std::to_string(shells_.size()) +
               " closed surfaces is inside out: that of " + name(shell.triangles.front()) + " at " +
               text_of(middle(shell.triangles.front())) + " m; turn its triangles");
    }
  }
  /// Whether a shell winds around a point, by the sum of solid angles of its triangles (Van
  /// Oosterom & Strackee 1983).
  bool is_inside(const Point3& point, const Shell& shell) const {
    for (std::size_t i = 0; i < 3; ++i)
      if (point[i] < shell.low[i] || point[i] > shell.high[i]) return false;
    double half_angle = 0;
    for (const std::int32_t t : shell.triangles) {
      const Point3 a = corner(t, 0) - point, b = corner(t, 1) - point, c = corner(t, 2) - point;
      const double la = length(a), lb = length(b), lc = length(c);
      half_angle += std::atan2(dot(a, cross(b, c)),
                               la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
    }
    return std::abs(half_angle) > std::numbers::pi;  // 2 pi inside, 0 outside
  }

  const Surface& surface_;
  std::string where_;
  std::vector<Shell> shells_;
};

}  // namespace

void check_surface(const Surface& surface, const std::string& where) {
  Checker(surface, where).check();
}

}  // namespace floe
