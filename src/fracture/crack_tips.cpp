#include "fracture/crack_tips.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "base/union_find.h"
#include "floe/base/item.h"
#include "floe/base/petsc.h"

namespace floe {
namespace {

/// A corner of a body in plan.
struct Corner {
  Point2 place;  ///< [m], world
  std::int32_t body;
  double angle;  ///< of the body at this corner [rad]
};

/// Corners in plan of a body, those of its bottom and top once. \param tolerance  [m]
void append_corners(const Lattice& lattice, std::int32_t body, double tolerance,
                    std::vector<Corner>& corners) {
  const Shapes& shapes = lattice.shapes;
  const auto b = static_cast<std::size_t>(body);
  const auto [w, x, y, z] = lattice.bodies.orientation[b];
  const Triad<double> axes = triad(Quat<double>{w, x, y, z});
  const std::size_t first = corners.size();
  for (std::int32_t v = shapes.vertex_of[b]; v < shapes.vertex_of[b + 1]; ++v) {
    const Point3 at = lattice.bodies.position[b] + axes.to_world(item(shapes.vertices, v));
    const Point2 place{at.x, at.y};
    const bool known = std::any_of(
        corners.begin() + static_cast<std::ptrdiff_t>(first), corners.end(), [&](const Corner& c) {
          return std::hypot(c.place[0] - place[0], c.place[1] - place[1]) <= tolerance;
        });
    if (!known) corners.push_back({place, body, 0});
  }
  // The body is convex, so its angle is the largest between directions to two other corners.
  for (std::size_t k = first; k < corners.size(); ++k) {
    for (std::size_t p = first; p < corners.size(); ++p) {
      for (std::size_t q = first; q < p; ++q) {
        if (p == k || q == k) continue;
        const double px = corners[p].place[0] - corners[k].place[0],
                     py = corners[p].place[1] - corners[k].place[1],
                     qx = corners[q].place[0] - corners[k].place[0],
                     qy = corners[q].place[1] - corners[k].place[1];
        corners[k].angle =
            std::max(corners[k].angle, std::abs(std::atan2(px * qy - py * qx, px * qx + py * qy)));
      }
    }
  }
}

/// Global beams by their bodies, sorted.
std::vector<std::pair<std::array<std::int32_t, 2>, std::int32_t>> by_bodies(const Beams& beams) {
  std::vector<std::pair<std::array<std::int32_t, 2>, std::int32_t>> all;
  all.reserve(beams.bodies.size());
  for (std::int32_t m = 0; m < beams.size(); ++m) all.emplace_back(item(beams.bodies, m), m);
  std::sort(all.begin(), all.end());
  return all;
}

}  // namespace

Junctions find_junctions(const Lattice& lattice) {
  Junctions found;
  found.of_beam.assign(lattice.beams.bodies.size(), {Junctions::none, Junctions::none});
  if (lattice.beams.size() == 0) return found;
  if (lattice.shapes.empty())
    throw InputError(
        "fracture: propagation: energy needs the vertices of the facets between bodies: the "
        "lattice file has no /shapes");
  double mean = 0;
  for (const double length : lattice.beams.length) mean += length;
  mean /= static_cast<double>(lattice.beams.bodies.size());
  const double tolerance = 1e-6 * mean;

  std::vector<Corner> corners;
  for (std::int32_t b = 0; b < lattice.bodies.size(); ++b)
    append_corners(lattice, b, tolerance, corners);
  std::sort(corners.begin(), corners.end(), [](const Corner& a, const Corner& b) {
    return std::pair(a.place, a.body) < std::pair(b.place, b.body);
  });
  UnionFind places(corners.size());
  for (std::size_t k = 0; k < corners.size(); ++k) {
    for (std::size_t j = k + 1;
         j < corners.size() && corners[j].place[0] - corners[k].place[0] <= tolerance; ++j) {
      if (std::abs(corners[j].place[1] - corners[k].place[1]) <= tolerance)
        places.unite(static_cast<std::int32_t>(k), static_cast<std::int32_t>(j));
    }
  }
  std::vector<std::pair<std::int32_t, std::int32_t>> members;  // place, corner
  for (std::size_t k = 0; k < corners.size(); ++k)
    members.emplace_back(places.find(static_cast<std::int32_t>(k)), static_cast<std::int32_t>(k));
  std::sort(members.begin(), members.end());

  const auto beams = by_bodies(lattice.beams);
  const auto beam_of = [&](std::int32_t a, std::int32_t b) {
    const std::array<std::int32_t, 2> pair{std::min(a, b), std::max(a, b)};
    const auto at = std::lower_bound(beams.begin(), beams.end(), std::pair(pair, std::int32_t{0}));
    return at != beams.end() && at->first == pair ? at->second : Junctions::none;
  };
  for (std::size_t begin = 0, end = 0; begin < members.size(); begin = end) {
    double angle = 0;
    std::vector<std::int32_t> bodies;
    for (end = begin; end < members.size() && members[end].first == members[begin].first; ++end) {
      const Corner& corner = item(corners, members[end].second);
      bodies.push_back(corner.body);
      angle += corner.angle;
    }
    constexpr double rounding = 1e-3;  // [rad]; bodies on the outline leave half a turn free
    if (bodies.size() != 3 || std::abs(angle - 2 * std::numbers::pi) > rounding) continue;
    const auto junction = static_cast<std::int32_t>(found.beams.size());
    const std::array<std::int32_t, 3> facets{beam_of(bodies[0], bodies[1]),
                                             beam_of(bodies[1], bodies[2]),
                                             beam_of(bodies[2], bodies[0])};
    found.beams.push_back(facets);
    for (const std::int32_t m : facets) {
      if (m == Junctions::none) continue;
      auto& ends = item(found.of_beam, m);
      (ends[0] == Junctions::none ? ends[0] : ends[1]) = junction;
    }
  }
  return found;
}

CrackTips::CrackTips(Junctions junctions)
    : junctions_(std::move(junctions)),
      gone_(junctions_.of_beam.size(), 0),
      lost_(junctions_.beams.size(), 0) {
  reset();
}

void CrackTips::reset() {
  std::fill(gone_.begin(), gone_.end(), std::uint8_t{0});
  for (std::size_t k = 0; k < lost_.size(); ++k) {
    const auto& facets = junctions_.beams[k];
    lost_[k] = static_cast<std::uint8_t>(std::count(facets.begin(), facets.end(), Junctions::none));
  }
}

bool CrackTips::is_tip(std::int32_t beam) const {
  if (item(gone_, beam) != 0) return false;
  const auto& ends = item(junctions_.of_beam, beam);
  return std::any_of(ends.begin(), ends.end(), [this](std::int32_t junction) {
    return junction != Junctions::none && item(lost_, junction) == 1;
  });
}

bool CrackTips::lose(std::int32_t beam) {
  if (item(gone_, beam) != 0) return false;
  item(gone_, beam) = 1;
  for (const std::int32_t junction : item(junctions_.of_beam, beam)) {
    if (junction != Junctions::none) ++item(lost_, junction);
  }
  return true;
}

}  // namespace floe
