/// \file
/// The interface of two convex polyhedra that touch or nearly touch: where ice that freezes between
/// them joins them.
#pragma once

#include <optional>
#include <span>

#include "floe/base/rotation.h"
#include "floe/geometry/polyhedron.h"

namespace floe {

/// The part of two convex bodies' faces that is near.
struct Interface {
  double gap;           ///< widest gap between parallel planes that part the bodies [m]; below 0
                        ///< where they overlap: minus the least depth
  Vec3<double> normal;  ///< unit vector across these planes, from A to B
  double area;          ///< across the normal [m^2]
  Vec3<double> centre;  ///< centroid of the area, midway between the two faces [m]
  Vec3<double> axis;    ///< unit vector in the plane along which the area extends most
  double most, least;   ///< second moments int u^2 dA along that axis and across it [m^4]
};

/// Returns the interface of two convex bodies: with the normal n of the widest gap (of all face
/// normals and cross products of edges; Gottschalk, Lin & Manocha 1996), the points of the plane
/// across n that have a face of A below and a face of B above, at most `reach` apart along n.
/// \param shapes    of both bodies
/// \param a, b      the bodies
/// \param placed_a, placed_b  world coordinates of their vertices [m]
/// \param reach     >= 0 [m]
/// \return nothing if the gap is wider than `reach`, or the area 0
std::optional<Interface> find_interface(const Shapes& shapes, std::int32_t a, std::int32_t b,
                                        std::span<const Point3> placed_a,
                                        std::span<const Point3> placed_b, double reach);

/// Whether a point is in a convex body, or within `by` of it beyond the plane of a face [m].
bool is_inside(const Shapes& shapes, std::int32_t body, std::span<const Point3> placed,
               const Point3& point, double by);

}  // namespace floe
