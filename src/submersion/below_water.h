/// \file
/// The submerged part of a body at any place and tilt, for the processor and for devices.
#pragma once

#include <cmath>

#include "geometry/submerged.h"
#include "submersion/prism.h"

namespace floe {

/// How the submerged parts of bodies that lie below the surface are found: by clipping, unless all
/// of a sphere about the body is below, or by the body's lowest and highest points. The volumes
/// differ by rounding.
enum class Wet { by_sphere, by_points };

/// The part of a body below z = 0 that is found by clipping; only what the surface may cut is
/// clipped.
/// \param body  prism(), extent() of the farthest vertex from the centroid [m], whole(axes), the
///   submerged part of all of it, and placed(axes), its faces from its centroid
/// \param axes  principal axes in the world
/// \param z     height of the centroid over the water [m]
template <class Body>
constexpr Submerged clipped_below(const Body& body, const Triad<double>& axes, double z, Wet wet) {
  if (z >= body.extent()) return {};
  if (z <= -body.extent()) return body.whole(axes);
  if (const Prism<double> p = body.prism(); is_prism(p)) {
    // Its end faces lie within discs of the plan's circumradius.
    const double middle = z + 0.5 * (p.top + p.bottom) * axes.e3.z;
    const double reach = 0.5 * (p.top - p.bottom) * std::abs(axes.e3.z) +
                         std::sqrt(p.radius2 * (axes.e1.z * axes.e1.z + axes.e2.z * axes.e2.z));
    if (middle > reach) return {};
    if (middle < -reach && wet == Wet::by_points) return body.whole(axes);
  }
  const auto faces = body.placed(axes);
  bool any_below = false, any_above = false;
  for (std::int32_t v = 0; v < faces.vertices(); ++v)
    (faces.vertex(v).z < -z ? any_below : any_above) = true;
  if (!any_below) return {};
  if (!any_above && wet == Wet::by_points) return body.whole(axes);
  return submerged_part(faces, -z);
}

/// The part of a body below z = 0.
/// \param body      as for clipped_below()
/// \param rotation  from rest, of unit length
template <class Body>
constexpr Submerged below_water(const Body& body, const Quat<double>& rotation, double z, Wet wet) {
  const Prism<double> b = body.prism();
  const PrismBelow<double> p = prism_below(b, rotation, z);
  if (!sides_only(b, p.axes, z)) return clipped_below(body, p.axes, z, wet);
  const Waterplane<double> w = waterplane_of(b, p);
  Submerged s;
  s.volume = p.volume;
  s.moment = p.moment;
  s.waterplane = w.area;
  s.wx = w.x, s.wy = w.y;
  s.wxx = w.xx, s.wxy = w.xy, s.wyy = w.yy;
  return s;
}

}  // namespace floe
