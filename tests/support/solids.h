/// \file
/// Solids for tests: surfaces of polygons, and files of them.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <numbers>
#include <string>
#include <vector>

#include "floe/base/item.h"
#include "solid/corner_cutting.h"
#include "solid/surface.h"

namespace floe::test {

/// Adds a polygon, counter-clockwise seen from outside.
inline void add_polygon(Surface& surface, const std::vector<std::int32_t>& polygon) {
  for (const auto& triangle : cut_corners(surface.vertices, polygon))
    surface.triangles.push_back(triangle);
}

/// The prism over a simple polygon, counter-clockwise, from z = 0 to `height`.
inline Surface prism(const std::vector<Point2>& plan, double height) {
  Surface s;
  const auto n = static_cast<std::int32_t>(plan.size());
  for (const double z : {0.0, height})
    for (const auto& [x, y] : plan) s.vertices.push_back({x, y, z});
  std::vector<std::int32_t> bottom, top;
  for (std::int32_t k = 0; k < n; ++k) {
    bottom.push_back(n - 1 - k);
    top.push_back(n + k);
  }
  add_polygon(s, bottom);
  add_polygon(s, top);
  for (std::int32_t k = 0; k < n; ++k) {
    const std::int32_t next = (k + 1) % n;
    add_polygon(s, {k, next, n + next, n + k});
  }
  return s;
}

inline Surface box(double x, double y, double z) {
  return prism({{0, 0}, {x, 0}, {x, y}, {0, y}}, z);
}
inline Surface l_shape() { return prism({{0, 0}, {3, 0}, {3, 1}, {1, 1}, {1, 2}, {0, 2}}, 1.5); }
inline Surface u_shape() {
  return prism({{0, 0}, {3, 0}, {3, 2}, {2, 2}, {2, 1}, {1, 1}, {1, 2}, {0, 2}}, 1.5);
}

/// The ring between two regular polygons around the z axis, from z = 0 to `height`.
inline Surface ring(std::int32_t sides, double inner, double outer, double height) {
  Surface s;
  for (const double z : {0.0, height}) {
    for (const double r : {inner, outer}) {
      for (std::int32_t k = 0; k < sides; ++k) {
        const double a = 2 * std::numbers::pi * k / sides;
        s.vertices.push_back({r * std::cos(a), r * std::sin(a), z});
      }
    }
  }
  const auto v = [&](int top, int out, std::int32_t k) {
    return (2 * top + out) * sides + k % sides;
  };
  for (std::int32_t k = 0; k < sides; ++k) {
    add_polygon(s, {v(1, 0, k), v(1, 1, k), v(1, 1, k + 1), v(1, 0, k + 1)});
    add_polygon(s, {v(0, 0, k), v(0, 0, k + 1), v(0, 1, k + 1), v(0, 1, k)});
    add_polygon(s, {v(0, 1, k), v(0, 1, k + 1), v(1, 1, k + 1), v(1, 1, k)});
    add_polygon(s, {v(0, 0, k), v(1, 0, k), v(1, 0, k + 1), v(0, 0, k + 1)});
  }
  return s;
}

/// The lower half of a hollow ball of plane facets, open upwards; m rows of n facets.
inline Surface bowl(std::int32_t n, std::int32_t m, double inner, double outer) {
  Surface s;
  for (const double r : {inner, outer}) {
    for (std::int32_t i = 0; i < m; ++i) {
      for (std::int32_t k = 0; k < n; ++k) {
        const double a = 2 * std::numbers::pi * k / n, b = std::numbers::pi / 2 * i / m;
        s.vertices.push_back(
            {r * std::cos(b) * std::cos(a), r * std::cos(b) * std::sin(a), -r * std::sin(b)});
      }
    }
    s.vertices.push_back({0, 0, -r});
  }
  const auto v = [&](int out, std::int32_t i, std::int32_t k) {
    return out * (m * n + 1) + (i == m ? m * n : i * n + k % n);
  };
  for (std::int32_t k = 0; k < n; ++k) {
    for (std::int32_t i = 0; i + 1 < m; ++i) {
      add_polygon(s, {v(1, i, k), v(1, i + 1, k), v(1, i + 1, k + 1), v(1, i, k + 1)});
      add_polygon(s, {v(0, i, k), v(0, i, k + 1), v(0, i + 1, k + 1), v(0, i + 1, k)});
    }
    add_polygon(s, {v(1, m - 1, k), v(1, m, k), v(1, m - 1, k + 1)});
    add_polygon(s, {v(0, m - 1, k), v(0, m - 1, k + 1), v(0, m, k)});
    add_polygon(s, {v(0, 0, k), v(1, 0, k), v(1, 0, k + 1), v(0, 0, k + 1)});
  }
  return s;
}

/// A torus of n times m quadrangles about the z axis.
inline Surface torus(std::int32_t n, std::int32_t m, double ring_radius, double tube_radius) {
  Surface s;
  for (std::int32_t i = 0; i < n; ++i) {
    for (std::int32_t j = 0; j < m; ++j) {
      const double a = 2 * std::numbers::pi * i / n, b = 2 * std::numbers::pi * j / m;
      const double r = ring_radius + tube_radius * std::cos(b);
      s.vertices.push_back({r * std::cos(a), r * std::sin(a), tube_radius * std::sin(b)});
    }
  }
  const auto v = [&](std::int32_t i, std::int32_t j) { return i % n * m + j % m; };
  for (std::int32_t i = 0; i < n; ++i)
    for (std::int32_t j = 0; j < m; ++j)
      add_polygon(s, {v(i, j), v(i + 1, j), v(i + 1, j + 1), v(i, j + 1)});
  return s;
}

/// Adds another surface, moved by `by`.
inline void add(Surface& surface, const Surface& other, const Point3& by) {
  const auto first = static_cast<std::int32_t>(surface.vertices.size());
  for (const Point3& p : other.vertices) surface.vertices.push_back(p + by);
  for (const auto& [a, b, c] : other.triangles)
    surface.triangles.push_back({a + first, b + first, c + first});
}

/// Turns a surface about an axis that is parallel to nothing in it, and moves it.
inline Surface turned(Surface surface) {
  const Quat<double> q = exp_rotation(Vec3<double>{0.3, -0.5, 0.7});
  for (Point3& p : surface.vertices) p = rotate(q, p) + Point3{1, 2, 3};
  return surface;
}

inline void write_obj(const Surface& surface, const std::string& path) {
  std::ofstream file(path);
  file.precision(17);
  for (const Point3& p : surface.vertices) file << "v " << p.x << ' ' << p.y << ' ' << p.z << '\n';
  for (const auto& [a, b, c] : surface.triangles)
    file << "f " << a + 1 << ' ' << b + 1 << ' ' << c + 1 << '\n';
}

inline void write_text_stl(const Surface& surface, const std::string& path) {
  std::ofstream file(path);
  file.precision(17);
  file << "solid made by a test\n";
  for (const auto& triangle : surface.triangles) {
    file << "facet normal 0 0 0\n outer loop\n";
    for (const std::int32_t v : triangle) {
      const Point3& p = item(surface.vertices, v);
      file << "  vertex " << p.x << ' ' << p.y << ' ' << p.z << '\n';
    }
    file << " endloop\nendfacet\n";
  }
  file << "endsolid\n";
}

/// The bytes of a binary STL file, whose heading begins as a text file's.
inline std::string binary_stl(const Surface& surface) {
  std::string bytes = "solid in 80 bytes";
  bytes.resize(80, ' ');
  const auto put = [&](std::uint32_t word) {
    for (unsigned k = 0; k < 4; ++k) bytes += static_cast<char>(word >> (8 * k) & 0xffU);
  };
  put(static_cast<std::uint32_t>(surface.triangles.size()));
  for (const auto& triangle : surface.triangles) {
    for (int k = 0; k < 3; ++k) put(0);
    for (const std::int32_t v : triangle)
      for (std::size_t i = 0; i < 3; ++i)
        put(std::bit_cast<std::uint32_t>(static_cast<float>(item(surface.vertices, v)[i])));
    bytes += std::string(2, '\0');
  }
  return bytes;
}

inline void write_bytes(const std::string& bytes, const std::string& path) {
  std::ofstream(path, std::ios::binary) << bytes;
}

}  // namespace floe::test
