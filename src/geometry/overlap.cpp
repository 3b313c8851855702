#include "geometry/overlap.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "floe/base/item.h"
#include "geometry/patch_sums.h"

namespace floe {
namespace {

std::span<const std::int32_t> corners_of(const Shapes& shapes, std::size_t face) {
  return {shapes.corners.data() + shapes.corner_of[face],
          shapes.corners.data() + shapes.corner_of[face + 1]};
}

/// Returns the plane of a face; nothing for a face without area, which bounds nothing.
std::optional<HalfSpace> plane_of(const Shapes& shapes, std::size_t face) {
  const auto corners = corners_of(shapes, face);
  const auto at = [&](std::size_t k) { return item(shapes.vertices, corners[k]); };
  Vec3<double> normal{};
  for (std::size_t k = 1; k + 1 < corners.size(); ++k)
    normal = normal + cross(at(k) - at(0), at(k + 1) - at(0));
  const double size = std::sqrt(dot(normal, normal));
  if (size == 0) return std::nullopt;
  normal = (1 / size) * normal;
  double offset = -std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < corners.size(); ++k) offset = std::max(offset, dot(normal, at(k)));
  return HalfSpace{normal, offset};
}

}  // namespace

void append_half_spaces(const Shapes& shapes, std::int32_t body, std::vector<HalfSpace>& planes) {
  const auto b = static_cast<std::size_t>(body);
  for (auto f = static_cast<std::size_t>(shapes.face_of[b]);
       f < static_cast<std::size_t>(shapes.face_of[b + 1]); ++f) {
    if (const auto plane = plane_of(shapes, f)) planes.push_back(*plane);
  }
}

double concavity(const Shapes& shapes, std::int32_t body) {
  double most = 0;
  const auto b = static_cast<std::size_t>(body);
  for (auto f = static_cast<std::size_t>(shapes.face_of[b]);
       f < static_cast<std::size_t>(shapes.face_of[b + 1]); ++f) {
    const auto plane = plane_of(shapes, f);
    if (!plane) continue;
    const auto beyond = [&](std::int32_t v) {
      return dot(plane->normal, item(shapes.vertices, v)) - plane->offset;
    };
    for (std::int32_t v = shapes.vertex_of[b]; v < shapes.vertex_of[b + 1]; ++v)
      most = std::max(most, beyond(v));
    for (const std::int32_t v : corners_of(shapes, f)) most = std::max(most, -beyond(v));
  }
  return most;
}

Overlap Clipper::overlap(const Shapes& shapes, std::int32_t body,
                         std::span<const Vec3<double>> placed, std::span<const HalfSpace> planes,
                         bool with_patch, const FurtherPlanes& further) {
  // Clip first by the plane that removes most of A, because the later cuts are then small.
  std::size_t first_plane = 0;
  double shallowest = -std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < planes.size(); ++k) {
    double deepest = std::numeric_limits<double>::infinity();
    for (const Vec3<double>& p : placed) deepest = std::min(deepest, dot(planes[k].normal, p));
    deepest -= planes[k].offset;
    if (deepest > 0) return {};
    if (deepest > shallowest) {
      shallowest = deepest;
      first_plane = k;
    }
  }
  start(shapes, body, placed);
  if (!cut(planes[first_plane])) return {};
  for (std::size_t k = 0; k < planes.size(); ++k) {
    if (k != first_plane && !cut(planes[k])) return {};
  }
  for (const HalfSpace& plane : further.b) {
    if (!cut(plane)) return {};
  }
  for (const HalfSpace& plane : further.a) {
    if (!cut(plane, false)) return {};
  }
  Overlap found = integrals();
  const double area = length(found.area);
  if (with_patch && area > 0) found.patch = patch((1 / area) * found.area);
  return found;
}

void Clipper::facets_on_b(FacetsOnB& facets) const {
  facets.clear();
  const auto corner = [&](std::int32_t c) { return item(now_.points, item(now_.corners, c)); };
  for (std::size_t f = 0; f < now_.faces.size(); ++f) {
    const Face& face = now_.faces[f];
    if (!face.on_b) continue;
    for (std::int32_t c = face.begin; c < face.end; ++c) {
      facets.edges.push_back({corner(c), corner(c + 1 < face.end ? c + 1 : face.begin)});
      if (c > face.begin && c + 1 < face.end)
        facets.corners.insert(facets.corners.end(), {corner(face.begin), corner(c), corner(c + 1)});
    }
  }
}

/// Sets now_ to the whole body.
void Clipper::start(const Shapes& shapes, std::int32_t body, std::span<const Vec3<double>> placed) {
  const auto b = static_cast<std::size_t>(body);
  const std::int32_t base = shapes.vertex_of[b];
  const std::int32_t first = item(shapes.corner_of, shapes.face_of[b]);
  const std::int32_t last = item(shapes.corner_of, shapes.face_of[b + 1]);
  now_.clear(placed.size(), static_cast<std::size_t>(last - first),
             static_cast<std::size_t>(shapes.face_of[b + 1] - shapes.face_of[b]));
  for (const Vec3<double>& p : placed) now_.points.push(p);
  for (std::int32_t f = shapes.face_of[b]; f < shapes.face_of[b + 1]; ++f) {
    const auto face = static_cast<std::size_t>(f);
    now_.faces.push({.begin = shapes.corner_of[face] - first,
                     .end = shapes.corner_of[face + 1] - first,
                     .on_b = false});
  }
  for (auto c = static_cast<std::size_t>(first); c < static_cast<std::size_t>(last); ++c)
    now_.corners.push(shapes.corners[c] - base);
}

/// Clips by one half-space; returns false if the rest is empty.
/// \param on_b  whether the plane is a face of B
bool Clipper::cut(const HalfSpace& plane, bool on_b) {
  const std::size_t n = now_.points.size();
  if (distance_.size() < n) {
    distance_.resize(n);
    place_.resize(n);
  }
  std::size_t inside = 0;
  for (std::size_t k = 0; k < n; ++k) {
    distance_[k] = dot(plane.normal, now_.points[k]) - plane.offset;
    inside += distance_[k] <= 0 ? 1 : 0;
  }
  if (inside == n) return true;
  if (inside == 0) return false;

  // At most every edge is crossed, which gives half as many crossings as corners. Each crossing is
  // a corner of both faces of its edge and of a cap.
  const std::size_t corners = now_.corners.size();
  next_.clear(n + corners, 3 * corners, now_.faces.size() + corners);
  crossings_.clear(corners);
  for (std::size_t k = 0; k < n; ++k) {  // without a branch, which would be mispredicted
    const bool in = distance_[k] <= 0;
    place_[k] = in ? static_cast<std::int32_t>(next_.points.size()) : -1;
    next_.points.push(now_.points[k]);
    next_.points.cut_back(next_.points.size() - (in ? 0 : 1));
  }
  const auto kept = static_cast<std::int32_t>(inside);
  for (std::size_t f = 0; f < now_.faces.size(); ++f) clip_face(now_.faces[f], kept);
  close_caps(kept, on_b);
  std::swap(now_, next_);
  return true;
}

/// Returns the crossing of an edge: made when the first face of the edge is clipped, found when the
/// second is.
std::int32_t Clipper::crossing(std::int32_t inside, std::int32_t outside) {
  for (std::size_t k = 0; k < crossings_.size(); ++k) {
    if (crossings_[k].inside == inside && crossings_[k].outside == outside)
      return static_cast<std::int32_t>(k);
  }
  const auto i = static_cast<std::size_t>(inside), o = static_cast<std::size_t>(outside);
  const double t = distance_[i] / (distance_[i] - distance_[o]);  // in [0, 1)
  next_.points.push(now_.points[i] + t * (now_.points[o] - now_.points[i]));
  crossings_.push({.inside = inside, .outside = outside, .next = -1, .done = false});
  return static_cast<std::int32_t>(crossings_.size()) - 1;
}

void Clipper::clip_face(const Face& face, std::int32_t kept) {
  std::int32_t inside = 0;
  for (std::int32_t c = face.begin; c < face.end; ++c) inside += place(c) >= 0 ? 1 : 0;
  if (inside == 0) return;
  const auto begin = static_cast<std::int32_t>(next_.corners.size());
  if (inside == face.end - face.begin) {
    for (std::int32_t c = face.begin; c < face.end; ++c) next_.corners.push(place(c));
    next_.faces.push({begin, static_cast<std::int32_t>(next_.corners.size()), face.on_b});
    return;
  }
  std::int32_t first_entered = -1, left = -1;
  std::int32_t last = face.end - 1;
  for (std::int32_t c = face.begin; c < face.end; last = c++) {
    const bool a_in = place(last) >= 0, b_in = place(c) >= 0;
    const std::int32_t a = item(now_.corners, last);
    const std::int32_t b = item(now_.corners, c);
    if (a_in && !b_in) {
      left = crossing(a, b);
      next_.corners.push(kept + left);
    } else if (!a_in && b_in) {
      const std::int32_t entered = crossing(b, a);
      next_.corners.push(kept + entered);
      // The cap runs against the face: from the face's entry to its exit.
      if (left >= 0) {
        item(crossings_, entered).next = left;
        left = -1;
      } else {
        first_entered = entered;
      }
    }
    if (b_in) next_.corners.push(place(c));
  }
  if (first_entered >= 0) item(crossings_, first_entered).next = left;
  next_.faces.push({begin, static_cast<std::int32_t>(next_.corners.size()), face.on_b});
}

void Clipper::close_caps(std::int32_t kept, bool on_b) {
  for (std::size_t start = 0; start < crossings_.size(); ++start) {
    if (crossings_[start].done) continue;
    const auto begin = static_cast<std::int32_t>(next_.corners.size());
    auto k = static_cast<std::int32_t>(start);
    while (!item(crossings_, k).done) {
      item(crossings_, k).done = true;
      next_.corners.push(kept + k);
      k = item(crossings_, k).next;
    }
    const auto end = static_cast<std::int32_t>(next_.corners.size());
    // A cap of two corners has no area. Without it the two faces beside it share that edge, so that
    // no edge ever has more than two faces.
    if (end - begin > 2) {
      next_.faces.push({.begin = begin, .end = end, .on_b = on_b});
    } else {
      next_.corners.cut_back(static_cast<std::size_t>(begin));
    }
  }
}

/// Sums cones over the triangles of all facets, with a vertex of the overlap as apex, so that all
/// numbers are as small as the overlap.
Overlap Clipper::integrals() const {
  const Vec3<double> apex = now_.points[0];
  double volume6 = 0;
  Vec3<double> moment24{}, area2{}, moment6{};  // about the apex
  for (std::size_t f = 0; f < now_.faces.size(); ++f) {
    const Face& face = now_.faces[f];
    const auto corner = [&](std::int32_t c) {
      return item(now_.points, item(now_.corners, c)) - apex;
    };
    const Vec3<double> p = corner(face.begin);
    Vec3<double> q = corner(face.begin + 1);
    for (std::int32_t c = face.begin + 2; c < face.end; ++c) {
      const Vec3<double> r = corner(c);
      const Vec3<double> twice = cross(q - p, r - p);
      const Vec3<double> sum = p + q + r;
      const double v = dot(p, twice);
      volume6 += v;
      moment24 = moment24 + v * sum;
      if (face.on_b) {
        area2 = area2 + twice;
        moment6 = moment6 + cross(sum, twice);
      }
      q = r;
    }
  }
  Overlap o;
  if (!(volume6 > 0)) return o;
  o.volume = volume6 / 6;
  const Vec3<double> c = (0.25 / volume6) * moment24;
  o.centroid = apex + c;
  o.area = 0.5 * area2;
  o.moment = (1.0 / 6) * moment6 - cross(c, o.area);
  return o;
}

/// \param n  unit vector along S
Patch Clipper::patch(const Vec3<double>& n) const {
  const Vec3<double> apex = now_.points[0];
  const auto corner = [&](std::int32_t c) {
    return item(now_.points, item(now_.corners, c)) - apex;
  };
  PatchSums sums(n, apex);
  for (std::size_t f = 0; f < now_.faces.size(); ++f) {
    const Face& face = now_.faces[f];
    if (!face.on_b) continue;
    const Vec3<double> p = corner(face.begin);
    for (std::int32_t k = face.begin + 2; k < face.end; ++k) sums.add(p, corner(k - 1), corner(k));
  }
  Patch sum = sums.patch();
  if (!(sum.area > 0)) return {};
  const Vec3<double> middle = sum.middle - apex;
  for (std::size_t f = 0; f < now_.faces.size(); ++f) {
    const Face& face = now_.faces[f];
    if (!face.on_b) continue;
    Across<double> a = sums.across(corner(face.end - 1) - middle);
    for (std::int32_t k = face.begin; k < face.end; ++k) {
      const Across<double> b = sums.across(corner(k) - middle);
      sum.reach += reach_of_edge(a, b);
      a = b;
    }
  }
  return sum;
}

}  // namespace floe
