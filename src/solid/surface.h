/// \file
/// Closed surfaces of triangles: what a solid's file holds.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "floe/geometry/polyhedron.h"

namespace floe {

/// A surface of triangles, counter-clockwise seen from outside. Triangles that meet share vertices.
struct Surface {
  using Triangle = std::array<std::int32_t, 3>;
  std::vector<Point3> vertices;     ///< [m]
  std::vector<Triangle> triangles;  ///< indices into `vertices`
  /// Line of the file from which each triangle comes, from 1; empty for binary files.
  std::vector<std::int32_t> lines;
};

/// Most triangles of a surface.
inline constexpr std::int64_t most_triangles = 1'000'000;

/// Returns the volume that a closed surface encloses (divergence theorem) [m^3].
double volume_of(const Surface& surface);

/// Reads the triangles of an STL file (binary or text) or an OBJ file, by the ending of its name.
/// Polygons of OBJ files are cut into triangles; of their other lines only vertices count. Corners
/// at the same coordinates become one vertex. Call on one rank.
/// \param unit  metres per unit of the file's coordinates
/// \param key   the option that named the file, for messages
/// \throws InputError if the file cannot be read, is no such file or is incomplete, has a number
/// that is not finite, no triangle, or more than `most_triangles`
Surface read_surface(const std::string& file, double unit, const std::string& key);

/// Checks that a surface encloses one or several solids apart from each other: no triangle without
/// area, every edge in exactly two triangles and once in each direction, no two triangles that
/// intersect or touch but at common edges and vertices, volume > 0, no shell inside another.
/// \param where  the beginning of messages, as in "KEY: 'FILE'"
/// \throws InputError naming what is wrong, and where
void check_surface(const Surface& surface, const std::string& where);

}  // namespace floe
