#include "floe/geometry/overlap.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace floe {
namespace {

Vec3<double> vector(const Point3& p) { return {p[0], p[1], p[2]}; }

}  // namespace

void append_half_spaces(const Shapes& shapes, std::int32_t body, std::vector<HalfSpace>& planes) {
  const auto b = static_cast<std::size_t>(body);
  for (auto f = static_cast<std::size_t>(shapes.face_of[b]);
       f < static_cast<std::size_t>(shapes.face_of[b + 1]); ++f) {
    const std::span corners(shapes.corners.data() + shapes.corner_of[f],
                            shapes.corners.data() + shapes.corner_of[f + 1]);
    const auto at = [&](std::size_t k) {
      return vector(shapes.vertices[static_cast<std::size_t>(corners[k % corners.size()])]);
    };
    Vec3<double> normal{};
    for (std::size_t k = 1; k + 1 < corners.size(); ++k)
      normal = normal + cross(at(k) - at(0), at(k + 1) - at(0));
    const double size = std::sqrt(dot(normal, normal));
    if (size == 0) continue;  // a face without area bounds nothing
    normal = (1 / size) * normal;
    double offset = -std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < corners.size(); ++k) offset = std::max(offset, dot(normal, at(k)));
    planes.push_back({normal, offset});
  }
}

double concavity(const Shapes& shapes, std::int32_t body) {
  std::vector<HalfSpace> planes;
  append_half_spaces(shapes, body, planes);
  double most = 0;
  const auto b = static_cast<std::size_t>(body);
  for (const HalfSpace& plane : planes) {
    for (std::int32_t v = shapes.vertex_of[b]; v < shapes.vertex_of[b + 1]; ++v)
      most =
          std::max(most, dot(plane.normal, vector(shapes.vertices[static_cast<std::size_t>(v)])) -
                             plane.offset);
  }
  return most;
}

Overlap Clipper::overlap(const Shapes& shapes, std::int32_t body,
                         std::span<const Vec3<double>> placed, std::span<const HalfSpace> planes) {
  const auto b = static_cast<std::size_t>(body);
  const std::int32_t base = shapes.vertex_of[b];
  now_.points.assign(placed.begin(), placed.end());
  now_.faces.clear();
  now_.corners.clear();
  const std::int32_t first = shapes.corner_of[static_cast<std::size_t>(shapes.face_of[b])];
  for (std::int32_t f = shapes.face_of[b]; f < shapes.face_of[b + 1]; ++f) {
    const auto face = static_cast<std::size_t>(f);
    now_.faces.push_back(
        {shapes.corner_of[face] - first, shapes.corner_of[face + 1] - first, false});
  }
  for (auto c = static_cast<std::size_t>(first);
       c <
       static_cast<std::size_t>(shapes.corner_of[static_cast<std::size_t>(shapes.face_of[b + 1])]);
       ++c)
    now_.corners.push_back(shapes.corners[c] - base);
  for (const HalfSpace& plane : planes) {
    if (!cut(plane)) return {};
  }
  return integrals();
}

/// Clips by one half-space; false if nothing is left.
bool Clipper::cut(const HalfSpace& plane) {
  const std::size_t n = now_.points.size();
  distance_.resize(n);
  std::size_t inside = 0;
  for (std::size_t k = 0; k < n; ++k) {
    distance_[k] = dot(plane.normal, now_.points[k]) - plane.offset;
    inside += distance_[k] <= 0 ? 1 : 0;
  }
  if (inside == n) return true;
  if (inside == 0) return false;

  place_.resize(n);
  next_.points.clear();
  next_.corners.clear();
  next_.faces.clear();
  crossings_.clear();
  for (std::size_t k = 0; k < n; ++k) {
    if (distance_[k] > 0) continue;
    place_[k] = static_cast<std::int32_t>(next_.points.size());
    next_.points.push_back(now_.points[k]);
  }
  const auto kept = static_cast<std::int32_t>(inside);
  for (const Face& face : now_.faces) clip_face(face, kept);
  close_caps(kept);
  std::swap(now_, next_);
  return true;
}

/// The crossing of an edge, made when its first face is clipped and found when its second is.
std::int32_t Clipper::crossing(std::int32_t inside, std::int32_t outside) {
  for (std::size_t k = 0; k < crossings_.size(); ++k) {
    if (crossings_[k].inside == inside && crossings_[k].outside == outside)
      return static_cast<std::int32_t>(k);
  }
  const auto i = static_cast<std::size_t>(inside), o = static_cast<std::size_t>(outside);
  const double t = distance_[i] / (distance_[i] - distance_[o]);  // in [0, 1)
  next_.points.push_back(now_.points[i] + t * (now_.points[o] - now_.points[i]));
  crossings_.push_back({inside, outside, -1, false});
  return static_cast<std::int32_t>(crossings_.size()) - 1;
}

void Clipper::clip_face(const Face& face, std::int32_t kept) {
  const auto begin = static_cast<std::int32_t>(next_.corners.size());
  std::int32_t first_entered = -1, left = -1;
  std::int32_t a = now_.corners[static_cast<std::size_t>(face.end) - 1];
  bool a_in = distance_[static_cast<std::size_t>(a)] <= 0;
  for (std::int32_t c = face.begin; c < face.end; ++c) {
    const std::int32_t b = now_.corners[static_cast<std::size_t>(c)];
    const bool b_in = distance_[static_cast<std::size_t>(b)] <= 0;
    if (a_in && !b_in) {
      left = crossing(a, b);
      next_.corners.push_back(kept + left);
    } else if (!a_in && b_in) {
      const std::int32_t entered = crossing(b, a);
      next_.corners.push_back(kept + entered);
      // The cap runs against the face: from where the face enters to where it has left.
      if (left >= 0) {
        crossings_[static_cast<std::size_t>(entered)].next = left;
        left = -1;
      } else {
        first_entered = entered;
      }
    }
    if (b_in) next_.corners.push_back(place_[static_cast<std::size_t>(b)]);
    a = b;
    a_in = b_in;
  }
  if (first_entered >= 0) crossings_[static_cast<std::size_t>(first_entered)].next = left;
  const auto end = static_cast<std::int32_t>(next_.corners.size());
  if (end > begin) next_.faces.push_back({begin, end, face.on_b});
}

void Clipper::close_caps(std::int32_t kept) {
  for (std::size_t start = 0; start < crossings_.size(); ++start) {
    if (crossings_[start].done) continue;
    const auto begin = static_cast<std::int32_t>(next_.corners.size());
    auto k = static_cast<std::int32_t>(start);
    while (!crossings_[static_cast<std::size_t>(k)].done) {
      crossings_[static_cast<std::size_t>(k)].done = true;
      next_.corners.push_back(kept + k);
      k = crossings_[static_cast<std::size_t>(k)].next;
    }
    const auto end = static_cast<std::int32_t>(next_.corners.size());
    // A cap of two corners has no area; without it the two faces beside it share that edge, and no
    // edge ever has more than two faces.
    if (end - begin > 2) {
      next_.faces.push_back({begin, end, true});
    } else {
      next_.corners.resize(static_cast<std::size_t>(begin));
    }
  }
}

/// Cones over the triangles of all facets, with a vertex of the overlap as apex: numbers are as
/// small as the overlap.
Overlap Clipper::integrals() const {
  const Vec3<double> apex = now_.points[0];
  double volume6 = 0;
  Vec3<double> moment24{}, area2{}, moment6{};  // about the apex
  for (const Face& face : now_.faces) {
    const auto corner = [&](std::int32_t c) {
      return now_.points[static_cast<std::size_t>(now_.corners[static_cast<std::size_t>(c)])] -
             apex;
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

}  // namespace floe
