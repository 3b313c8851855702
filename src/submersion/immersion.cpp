#include "submersion/immersion.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include "floe/base/item.h"
#include "geometry/connected_parts.h"

namespace floe {
namespace {

void put(const Submerged& s, std::size_t lane, Immersion::Lane& below) {
  below.volume[lane] = s.volume;
  below.moment.x[lane] = s.moment.x;
  below.moment.y[lane] = s.moment.y;
  below.moment.z[lane] = s.moment.z;
}

}  // namespace

Immersion::Immersion(const Part& part, Wet wet, TimeTable level)
    : part_(part), wet_(wet), level_(std::move(level)) {
  const auto owned = static_cast<std::size_t>(part.owned);
  blocks_.resize((owned + lanes - 1) / lanes);
  for (std::size_t b = 0; b < owned; ++b) {
    const bool has_shape = part.shapes.vertex_of[b] < part.shapes.vertex_of[b + 1];
    whole_.push_back(has_shape ? volume_properties(part.shapes, static_cast<std::int32_t>(b))
                               : VolumeProperties{});
    double extent = 0;
    for (std::int32_t v = part.shapes.vertex_of[b]; v < part.shapes.vertex_of[b + 1]; ++v) {
      const Point3& r = item(part.shapes.vertices, v);
      extent = std::max(extent, std::hypot(r.x, r.y, r.z));
    }
    extent_.push_back(extent);
  }
  for (std::size_t k = 0; k < blocks_.size() * lanes; ++k) {
    const Prism<double> p = find_prism(body_of(k / lanes, k % lanes));
    const std::array<double, Prism<double>::numbers> all{
        p.axes.w, p.axes.x, p.axes.y, p.axes.z, p.z,  p.bottom, p.top,
        p.area,   p.x,      p.y,      p.xx,     p.xy, p.yy,     p.radius2};
    for (std::size_t n = 0; n < all.size(); ++n) blocks_[k / lanes].values[n][k % lanes] = all[n];
  }
}

/// Finds out whether owned body b is a prism along axis 3: one face at the bottom, one at the top
/// with a corner above each corner of the bottom, and no other vertex.
Prism<double> Immersion::find_prism(std::size_t b) const {
  const auto [qw, qx, qy, qz] = part_.bodies.orientation[b];
  Prism<double> prism{};
  prism.axes = {qw, qx, qy, qz};
  prism.z = part_.bodies.position[b][2];
  prism.radius2 = std::numeric_limits<double>::infinity();
  const Shapes& shapes = part_.shapes;
  const std::span vertices(shapes.vertices.data() + shapes.vertex_of[b],
                           shapes.vertices.data() + shapes.vertex_of[b + 1]);
  if (vertices.empty()) return prism;
  const auto [low, high] =
      std::minmax_element(vertices.begin(), vertices.end(),
                          [](const Point3& p, const Point3& q) { return p[2] < q[2]; });
  const double bottom = (*low)[2], top = (*high)[2];
  const double near = 1e-13 * extent_[b];
  std::vector<Point2> plan;
  for (auto f = static_cast<std::size_t>(shapes.face_of[b]);
       f < static_cast<std::size_t>(shapes.face_of[b + 1]); ++f) {
    const std::span corners(shapes.corners.data() + shapes.corner_of[f],
                            shapes.corners.data() + shapes.corner_of[f + 1]);
    const auto at = [&](std::int32_t v) { return item(shapes.vertices, v); };
    if (!std::all_of(corners.begin(), corners.end(),
                     [&](std::int32_t v) { return at(v)[2] <= bottom + near; }))
      continue;
    // Corners run counter-clockwise seen from outside, hence clockwise seen from above.
    for (auto v = corners.rbegin(); v != corners.rend(); ++v)
      plan.push_back({at(*v)[0], at(*v)[1]});
  }
  const auto over = [&](const Point2& p) {
    return std::any_of(vertices.begin(), vertices.end(), [&](const Point3& v) {
      return v[2] >= top - near && std::hypot(v[0] - p[0], v[1] - p[1]) <= near;
    });
  };
  if (2 * plan.size() != vertices.size() || !std::all_of(plan.begin(), plan.end(), over))
    return prism;

  const PlanProperties p = plan_properties(plan);
  const auto [x, y] = p.centroid;
  prism.bottom = bottom, prism.top = top;
  prism.area = p.area;
  prism.x = p.area * x, prism.y = p.area * y;
  prism.xx = p.xx + p.area * x * x;
  prism.xy = p.xy + p.area * x * y;
  prism.yy = p.yy + p.area * y * y;
  prism.radius2 = 0;
  for (const auto& [px, py] : plan) prism.radius2 = std::max(prism.radius2, px * px + py * py);
  return prism;
}

Submerged Immersion::of(const State<Spatial>& state, std::int32_t body) const {
  const auto b = static_cast<std::size_t>(body);
  return placed(body, of_unit_length(rotation(state, b)), height(state, body));
}

bool Immersion::is_cut_across(const State<Spatial>& state, std::int32_t body) const {
  const auto b = static_cast<std::size_t>(body);
  const double z = height(state, body);
  if (!(std::abs(z) < extent_[b])) return false;
  const Prism<double> p = prism(b);
  return !sides_only(p, triad(product(of_unit_length(rotation(state, b)), p.axes)), z);
}

Submerged Immersion::below(const State<Spatial>& state, std::int32_t body,
                           const SurfacePlane& plane) const {
  const auto b = static_cast<std::size_t>(body);
  return placed(body, product(plane.to_level(), of_unit_length(rotation(state, b))),
                (centroid(state, body).z - plane.level) / plane.steepness());
}

/// A body for below_water(), with its vertices placed once.
struct Immersion::Placed {
  const Immersion& all;
  std::int32_t body;

  Prism<double> prism() const { return all.prism(static_cast<std::size_t>(body)); }
  double extent() const { return all.extent(body); }
  Submerged whole(const Triad<double>& axes) const {
    const VolumeProperties& of = all.all_of_body(body);
    Submerged s;
    s.volume = of.volume;
    s.moment = of.volume * axes.to_world(of.centroid);
    return s;
  }
  PlacedFaces placed(const Triad<double>& axes) const {
    all.place_vertices(body, axes);
    return {all.part_.shapes, body, all.placed_};
  }
};

Submerged Immersion::placed(std::int32_t body, const Quat<double>& rotation, double z) const {
  return below_water(Placed{*this, body}, rotation, z, wet_);
}

void Immersion::replace(const State<Spatial>& state, std::size_t block, std::size_t lane,
                        Lane& below) const {
  put(of(state, static_cast<std::int32_t>(body_of(block, lane))), lane, below);
}

void Immersion::replace(const State<Spatial>& state, std::size_t block, std::size_t lane,
                        Cut& cut) const {
  const Submerged s = of(state, static_cast<std::int32_t>(body_of(block, lane)));
  put(s, lane, cut.below);
  cut.waterplane.area[lane] = s.waterplane;
  cut.waterplane.x[lane] = s.wx;
  cut.waterplane.y[lane] = s.wy;
  cut.waterplane.xx[lane] = s.wxx;
  cut.waterplane.xy[lane] = s.wxy;
  cut.waterplane.yy[lane] = s.wyy;
}

double Immersion::plan_area(std::int32_t body) const {
  // Each point of the plan view lies below one face of a convex body and above another, so the
  // projected areas of the faces add up to twice the plan area.
  const auto b = static_cast<std::size_t>(body);
  const Shapes& shapes = part_.shapes;
  const Triad<double> axes = triad(prism(b).axes);
  double twice = 0;
  std::vector<Point2> face;
  std::vector<std::vector<Point2>> upward;  // faces; of several parts they may lie above each other
  const bool has_parts = number_of_parts(shapes, body) > 1;
  for (auto f = static_cast<std::size_t>(shapes.face_of[b]);
       f < static_cast<std::size_t>(shapes.face_of[b + 1]); ++f) {
    face.clear();
    for (auto c = static_cast<std::size_t>(shapes.corner_of[f]);
         c < static_cast<std::size_t>(shapes.corner_of[f + 1]); ++c) {
      const Vec3<double> p = axes.to_world(item(shapes.vertices, shapes.corners[c]));
      face.push_back({p.x, p.y});
    }
    const double area = plan_properties(face).area;
    twice += std::abs(area);
    if (has_parts && area > 0) upward.push_back(face);
  }
  return has_parts ? area_of_union(upward) : twice / 2;
}

Submerged Immersion::by_clipping(const State<Spatial>& state, std::int32_t body) const {
  const auto b = static_cast<std::size_t>(body);
  const Quat<double> axes = product(of_unit_length(rotation(state, b)), prism(b).axes);
  place_vertices(body, triad(axes));
  return submerged(part_.shapes, body, placed_, -height(state, body));
}

void Immersion::place_vertices(std::int32_t body, const Triad<double>& axes) const {
  const auto b = static_cast<std::size_t>(body);
  const Shapes& shapes = part_.shapes;
  placed_.clear();
  for (std::int32_t v = shapes.vertex_of[b]; v < shapes.vertex_of[b + 1]; ++v)
    placed_.push_back(axes.to_world(item(shapes.vertices, v)));
}

}  // namespace floe
