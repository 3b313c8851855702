/// \file
/// The part of a polyhedron below a level, face by face.
#pragma once

#include <cstdint>
#include <span>

#include "floe/base/item.h"
#include "floe/geometry/polyhedron.h"

namespace floe {

/// Sums of cones with one apex over triangles: six times the volume, and 24 times the first moment
/// about the apex.
struct Cones {
  Point3 apex;
  double volume6 = 0;
  Point3 moment24{};

  constexpr void add(const Point3& p, const Point3& q, const Point3& r) {
    const Point3 a = p - apex, b = q - apex, c = r - apex;
    const double v = dot(a, cross(b, c));
    volume6 += v;
    moment24 = moment24 + v * (a + b + c);
  }
};

/// The faces of a body whose vertices are placed.
struct PlacedFaces {
  const Shapes& shapes;
  std::int32_t body;
  std::span<const Point3> placed;

  std::int32_t vertices() const { return static_cast<std::int32_t>(placed.size()); }
  const Point3& vertex(std::int32_t v) const { return item(placed, v); }
  std::int32_t first_face() const { return item(shapes.face_of, body); }
  std::int32_t end_face() const { return item(shapes.face_of, body + 1); }
  std::int32_t first_corner(std::int32_t face) const { return item(shapes.corner_of, face); }
  const Point3& corner(std::int32_t c) const {
    return vertex(item(shapes.corners, c) - item(shapes.vertex_of, body));
  }
};

/// Returns the submerged part of a body, as submerged() does.
/// \param faces  vertices() and vertex(v); first_face(), end_face(); first_corner(face), which is
///   also the end of the face before, and corner(c), counter-clockwise seen from outside
template <class Faces>
constexpr Submerged submerged_part(const Faces& faces, double level) {
  Submerged s;
  bool any_below = false, any_above = false;
  for (std::int32_t v = 0; v < faces.vertices(); ++v)
    (faces.vertex(v)[2] < level ? any_below : any_above) = true;
  if (!any_below) return s;

  // The apex of all cones lies in the plane of the water, so that the cut itself contributes
  // nothing and each face can be clipped on its own, without a list of its remaining parts. The
  // other two coordinates are the first vertex's, for small numbers.
  Cones cones{faces.vertex(0)};
  if (any_above) cones.apex[2] = level;
  const Point3& o = cones.apex;
  double cut2 = 0, sx = 0, sy = 0, xx = 0, yy = 0,
         xy = 0;  // Green's sums of the cut, about the apex

  // Returns the point in which the edge from a (below) to b (not below) meets the plane. Both faces
  // of an edge get the same bits.
  const auto crossing = [level](const Point3& a, const Point3& b) {
    const double t = (level - a[2]) / (b[2] - a[2]);
    return Point3{a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]), level};
  };

  for (std::int32_t f = faces.first_face(); f < faces.end_face(); ++f) {
    const std::int32_t begin = faces.first_corner(f), end = faces.first_corner(f + 1);
    Point3 first{}, previous{}, leaves{}, enters{};
    int emitted = 0;
    bool cut = false;
    const auto emit = [&](const Point3& p) {
      if (emitted == 0) first = p;
      if (emitted >= 2) cones.add(first, previous, p);
      previous = p;
      ++emitted;
    };
    for (std::int32_t k = begin; k < end; ++k) {
      const Point3 a = faces.corner(k), b = faces.corner(k + 1 < end ? k + 1 : begin);
      const bool a_below = a[2] < level, b_below = b[2] < level;
      if (a_below) emit(a);
      if (a_below && !b_below) {
        leaves = crossing(a, b);
        cut = true;
        emit(leaves);
      } else if (!a_below && b_below) {
        enters = crossing(b, a);
        emit(enters);
      }
    }
    if (!cut) continue;
    // Seen from above, the part of the cut's boundary on this face runs against the face's
    // direction.
    const double ax = enters[0] - o[0], ay = enters[1] - o[1];
    const double bx = leaves[0] - o[0], by = leaves[1] - o[1];
    const double c = ax * by - bx * ay;
    cut2 += c;
    sx += c * (ax + bx);
    sy += c * (ay + by);
    xx += c * (ax * ax + ax * bx + bx * bx);
    yy += c * (ay * ay + ay * by + by * by);
    xy += c * (2 * (ax * ay + bx * by) + ax * by + bx * ay);
  }
  s.volume = cones.volume6 / 6;
  for (std::size_t i = 0; i < 3; ++i) s.moment[i] = cones.moment24[i] / 24 + s.volume * o[i];
  s.waterplane = cut2 / 2;
  const double lx = sx / 6, ly = sy / 6;  // first moments about the apex, then all about (0, 0)
  s.wx = lx + s.waterplane * o[0];
  s.wy = ly + s.waterplane * o[1];
  s.wxx = xx / 12 + 2 * o[0] * lx + s.waterplane * o[0] * o[0];
  s.wyy = yy / 12 + 2 * o[1] * ly + s.waterplane * o[1] * o[1];
  s.wxy = xy / 24 + o[0] * ly + o[1] * lx + s.waterplane * o[0] * o[1];
  return s;
}

}  // namespace floe
