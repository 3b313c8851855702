#include "fracture_laws/crack_tips.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "base/union_find.h"
#include "floe/base/item.h"
#include "floe/base/petsc.h"
#include "lattice/permute.h"

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

/// Moduli of the sheet over its beams' Young's modulus, for means of its beams. Those of the beams
/// themselves if the lattice gives no sections: such beams cannot break. Beams without a facet are
/// not the sheet's. \param facets  per beam: its facet, or none
LatticeModuli moduli_of(const Lattice& lattice, const std::vector<std::int32_t>& facets,
                        Shear shear) {
  const Beams& b = lattice.beams;
  const std::size_t all = b.bodies.size();
  if (b.width.size() != all || b.torsion.size() != all || b.young.size() != all)
    return {
        .young = 1, .poisson = 0, .shear = 0.5, .bulk = 0.5, .bending = 1, .bending_poisson = 0};
  std::vector<std::int32_t> of_sheet;
  for (std::int32_t m = 0; m < b.size(); ++m)
    if (item(facets, m) != Junctions::none) of_sheet.push_back(m);
  if (of_sheet.empty() || of_sheet.size() == all)
    return lattice_moduli(lattice_ratios(lattice, shear), 0, shear);
  Lattice sheet;
  sheet.bodies = lattice.bodies, sheet.beams = pick(b, of_sheet), sheet.sets = lattice.sets;
  return lattice_moduli(lattice_ratios(sheet, shear), 0, shear);
}

/// Global beams by their bodies, sorted.
std::vector<std::pair<std::array<std::int32_t, 2>, std::int32_t>> by_bodies(const Beams& beams) {
  std::vector<std::pair<std::array<std::int32_t, 2>, std::int32_t>> all;
  all.reserve(beams.bodies.size());
  for (std::int32_t m = 0; m < beams.size(); ++m) all.emplace_back(item(beams.bodies, m), m);
  std::sort(all.begin(), all.end());
  return all;
}

/// A place where bodies meet, with the pairs of bodies that are neighbours around it.
struct Meeting {
  std::array<std::int32_t, 2> bodies;
  Point2 place;
  std::int32_t junction;  ///< or none
};

/// Groups of corners at one place. \return place, corner, sorted
std::vector<std::pair<std::int32_t, std::int32_t>> by_places(const std::vector<Corner>& corners,
                                                             double tolerance) {
  UnionFind places(corners.size());
  for (std::size_t k = 0; k < corners.size(); ++k) {
    for (std::size_t j = k + 1;
         j < corners.size() && corners[j].place[0] - corners[k].place[0] <= tolerance; ++j) {
      if (std::abs(corners[j].place[1] - corners[k].place[1]) <= tolerance)
        places.unite(static_cast<std::int32_t>(k), static_cast<std::int32_t>(j));
    }
  }
  std::vector<std::pair<std::int32_t, std::int32_t>> members;
  for (std::size_t k = 0; k < corners.size(); ++k)
    members.emplace_back(places.find(static_cast<std::int32_t>(k)), static_cast<std::int32_t>(k));
  std::sort(members.begin(), members.end());
  return members;
}

/// Notes the neighbours around one place; a place that bodies surround becomes a junction.
/// \param corners  of the bodies at this place
void meet(const Lattice& lattice, std::vector<Corner> corners, Junctions& found,
          std::vector<Meeting>& meetings) {
  constexpr double rounding = 1e-3;  // [rad]; bodies on the outline leave half a turn free
  if (corners.size() < 2) return;
  double angle = 0;
  for (const Corner& c : corners) angle += c.angle;
  const Point2 place = corners.front().place;
  std::int32_t junction = Junctions::none;
  if (corners.size() >= 3 && std::abs(angle - 2 * std::numbers::pi) <= rounding) {
    junction = found.size();
    found.places.push_back(place);
  }
  const auto direction = [&](const Corner& c) {
    const Point3& x = item(lattice.bodies.position, c.body);
    return std::atan2(x.y - place[1], x.x - place[0]);
  };
  std::sort(corners.begin(), corners.end(),
            [&](const Corner& a, const Corner& b) { return direction(a) < direction(b); });
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const std::int32_t a = corners[k].body, b = corners[(k + 1) % corners.size()].body;
    if (corners.size() == 2 && k == 1) break;
    meetings.push_back({{std::min(a, b), std::max(a, b)}, place, junction});
  }
}

/// Adds the facets between bodies that meet at two places, one of them a junction at least.
/// \param meetings  sorted by bodies
void add_facets(const Lattice& lattice, const std::vector<Meeting>& meetings, Junctions& found) {
  const auto beams = by_bodies(lattice.beams);
  std::vector<std::pair<std::int32_t, std::int32_t>> at;  // junction, facet
  for (std::size_t k = 0; k + 1 < meetings.size(); ++k) {
    const Meeting &a = meetings[k], &b = meetings[k + 1];
    if (a.bodies != b.bodies || (a.junction == Junctions::none && b.junction == Junctions::none))
      continue;
    const auto [i, j] = a.bodies;
    const Point3 &xi = item(lattice.bodies.position, i), &xj = item(lattice.bodies.position, j);
    const auto beam = std::lower_bound(beams.begin(), beams.end(), std::pair(a.bodies, 0));
    const bool joined = beam != beams.end() && beam->first == a.bodies;
    const double height = joined ? xi.z + offset(lattice.beams, beam->second, 0).z + xj.z +
                                       offset(lattice.beams, beam->second, 1).z
                                 : xi.z + xj.z;
    const Point3 middle{0.5 * (a.place[0] + b.place[0]), 0.5 * (a.place[1] + b.place[1]),
                        0.5 * height};
    const auto facet = static_cast<std::int32_t>(found.facets.size());
    found.facets.push_back({.bodies = a.bodies,
                            .beam = joined ? beam->second : Junctions::none,
                            .junctions = {a.junction, b.junction},
                            .middle = middle,
                            .arm = {middle - xi, middle - xj},
                            .width = std::hypot(b.place[0] - a.place[0], b.place[1] - a.place[1])});
    if (joined) item(found.facet_of, beam->second) = facet;
    for (const std::int32_t junction : {a.junction, b.junction}) {
      if (junction != Junctions::none) at.emplace_back(junction, facet);
    }
  }
  std::sort(at.begin(), at.end());
  found.first.assign(found.places.size() + 1, 0);
  for (const auto& [junction, facet] : at) {
    found.facets_at.push_back(facet);
    ++found.first[static_cast<std::size_t>(junction) + 1];
  }
  for (std::size_t k = 1; k < found.first.size(); ++k) found.first[k] += found.first[k - 1];
}

}  // namespace

Junctions find_junctions(const Lattice& lattice, Shear shear) {
  Junctions found;
  found.facet_of.assign(lattice.beams.bodies.size(), Junctions::none);
  found.first = {0};
  if (lattice.beams.size() == 0) return found;
  if (lattice.shapes.empty())
    throw InputError(
        "fracture: propagation: energy needs the vertices of the facets between "
        "bodies, and the lattice file has no /shapes: add them, or take propagation: strength");
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
  const auto members = by_places(corners, tolerance);
  std::vector<Meeting> meetings;
  for (std::size_t begin = 0, end = 0; begin < members.size(); begin = end) {
    std::vector<Corner> here;
    for (end = begin; end < members.size() && members[end].first == members[begin].first; ++end)
      here.push_back(item(corners, members[end].second));
    meet(lattice, std::move(here), found, meetings);
  }
  std::stable_sort(meetings.begin(), meetings.end(),
                   [](const Meeting& a, const Meeting& b) { return a.bodies < b.bodies; });

  add_facets(lattice, meetings, found);
  found.moduli = moduli_of(lattice, found.facet_of, shear);
  return found;
}

CrackTips::CrackTips(Junctions junctions)
    : junctions_(std::move(junctions)),
      gone_(junctions_.facets.size(), 0),
      lost_(junctions_.places.size(), 0) {
  reset();
}

void CrackTips::reset() {
  for (std::size_t f = 0; f < gone_.size(); ++f)
    gone_[f] = junctions_.facets[f].beam == Junctions::none ? 1 : 0;
  for (std::int32_t k = 0; k < junctions_.size(); ++k) {
    const auto facets = junctions_.at(k);
    item(lost_, k) = static_cast<std::uint8_t>(std::count_if(
        facets.begin(), facets.end(), [&](std::int32_t f) { return item(gone_, f) != 0; }));
  }
}

bool CrackTips::is_tip(std::int32_t beam) const {
  const std::int32_t facet = item(junctions_.facet_of, beam);
  if (facet == Junctions::none || item(gone_, facet) != 0) return false;
  const auto& ends = item(junctions_.facets, facet).junctions;
  return std::any_of(ends.begin(), ends.end(), [this](std::int32_t junction) {
    return junction != Junctions::none && item(lost_, junction) == 1;
  });
}

bool CrackTips::lose(std::int32_t beam) {
  const std::int32_t facet = item(junctions_.facet_of, beam);
  if (facet == Junctions::none || item(gone_, facet) != 0) return false;
  item(gone_, facet) = 1;
  for (const std::int32_t junction : item(junctions_.facets, facet).junctions) {
    if (junction != Junctions::none) ++item(lost_, junction);
  }
  return true;
}

std::int32_t CrackTips::goes_on(std::int32_t junction, std::int32_t facet) const {
  std::int32_t other = Junctions::none;
  for (const std::int32_t f : junctions_.at(junction)) {
    if (f == facet || item(gone_, f) == 0) continue;
    if (other != Junctions::none) return Junctions::none;
    other = f;
  }
  return other;
}

CrackBehind CrackTips::behind_junction(std::int32_t junction) const {
  CrackBehind crack{.facets = {}, .size = 0, .tip = item(junctions_.places, junction)};
  std::int32_t facet = goes_on(junction, Junctions::none);
  for (std::size_t k = 0; facet != Junctions::none && k < CrackBehind::farthest; ++k) {
    if (crack.size < CrackBehind::most) crack.facets[crack.size++] = facet;
    const auto& ends = item(junctions_.facets, facet).junctions;
    junction = ends[0] == junction ? ends[1] : ends[0];
    if (junction == Junctions::none) break;  // the outline
    facet = goes_on(junction, facet);
    if (facet == Junctions::none && item(lost_, junction) == 1) {
      const Point2& other = item(junctions_.places, junction);
      crack.length = std::hypot(other[0] - crack.tip[0], other[1] - crack.tip[1]);
    }
  }
  return crack;
}

std::vector<CrackBehind> CrackTips::behind(std::int32_t beam) const {
  std::vector<CrackBehind> cracks;
  if (!is_tip(beam)) return cracks;
  for (const std::int32_t k : item(junctions_.facets, item(junctions_.facet_of, beam)).junctions) {
    if (k == Junctions::none || item(lost_, k) != 1) continue;
    const CrackBehind crack = behind_junction(k);
    if (crack.size >= CrackBehind::least) cracks.push_back(crack);
  }
  return cracks;
}

void CrackTips::append_bodies(std::span<const CrackBehind> cracks,
                              std::vector<std::int32_t>& bodies) const {
  for (const CrackBehind& crack : cracks) {
    for (std::size_t k = 0; k < crack.size; ++k) {
      const auto& pair = item(junctions_.facets, crack.facets[k]).bodies;
      bodies.insert(bodies.end(), pair.begin(), pair.end());
    }
  }
}

namespace {
/// The mode I intensity whose hoop stress ahead of a tip is the largest of modes I and II together
/// (Erdogan & Sih 1963): it is in the direction t with k1 sin t + k2 (3 cos t - 1) = 0.
double hoop_intensity(double k1, double k2) {
  if (k2 == 0) return k1;
  const double half = std::atan((k1 - std::sqrt(k1 * k1 + 8 * k2 * k2)) / (4 * k2));
  const double cosine = std::cos(half);
  return cosine * (k1 * cosine * cosine - 1.5 * k2 * std::sin(2 * half));
}
}  // namespace

double CrackTips::opening(const CrackBehind& crack, double bent, bool linear,
                          const std::function<BodyPose(std::int32_t)>& pose_of) const {
  const auto displaced = [linear](const BodyPose& p, const Point3& arm) {
    const Vec3<double> v{p.q.x, p.q.y, p.q.z}, t = cross(v, arm);
    return p.u + (linear ? 2.0 * t : 2.0 * (p.q.w * t + cross(v, t)));
  };
  // Normal equations of the fit of (c + b r) g, g = sqrt(r (1 - r/L)), to the jumps
  Vec3<double> jumps{0, 0, 0}, jumps_r{0, 0, 0}, turns{0, 0, 0}, back{0, 0, 0};
  double gg = 0, grg = 0, rgrg = 0, weight = 0;
  Quat<double> turned{1, 0, 0, 0};
  Point2 nearer = crack.tip;
  for (std::size_t k = 0; k < crack.size; ++k) {
    const CrackFacet& f = item(junctions_.facets, crack.facets[k]);
    const BodyPose i = pose_of(f.bodies[0]), j = pose_of(f.bodies[1]);
    // The facet is passed towards the tip; its bodies are to the left and to the right.
    const double tx = nearer[0] - f.middle.x, ty = nearer[1] - f.middle.y;
    const Point3 across = f.arm[0] - f.arm[1];
    const double side = tx * across.y - ty * across.x > 0 ? 1.0 : -1.0;
    const double r = std::hypot(f.middle.x - crack.tip[0], f.middle.y - crack.tip[1]);
    const Vec3<double> up = linear ? Vec3<double>{0, 0, 1} : triad(i.q).e3;
    Vec3<double> jump = displaced(j, f.arm[1]) - displaced(i, f.arm[0]);
    jump = jump - dot(jump, up) * up;  // the deflection's goes with r^(3/2), not with K
    const Quat<double> turn = product(j.q, conjugate(i.q));
    Vec3<double> psi{2 * turn.x, 2 * turn.y, 2 * turn.z};
    if (linear) psi = {2 * (j.q.x - i.q.x), 2 * (j.q.y - i.q.y), 2 * (j.q.z - i.q.z)};
    if (!linear && turn.w < 0) psi = -psi;
    psi = psi - dot(psi, up) * up;
    const double shape2 = r * std::max(0.0, 1 - r / crack.length);
    const double far = f.width * r * r, g = side * std::sqrt(shape2);
    jumps = jumps + (far * g) * jump, jumps_r = jumps_r + (far * r * g) * jump;
    gg += far * shape2, grg += far * r * shape2, rgrg += far * r * r * shape2;
    turns = turns + (f.width * g) * psi, weight += f.width * shape2;
    back = back + f.width * Vec3<double>{crack.tip[0] - f.middle.x, crack.tip[1] - f.middle.y, 0};
    if (k == 0 && !linear) turned = i.q;
    const std::int32_t next = k + 1 < crack.size ? crack.facets[k + 1] : Junctions::none;
    if (next == Junctions::none) break;
    for (const std::int32_t end : f.junctions) {
      const auto& of_next = item(junctions_.facets, next).junctions;
      if (end != Junctions::none && (end == of_next[0] || end == of_next[1]))
        nearer = item(junctions_.places, end);
    }
  }
  if (weight == 0) return 0;
  const double determinant = gg * rgrg - grg * grg;
  // Facets at one distance do not tell r from its root.
  const Vec3<double> c = determinant > 1e-9 * gg * rgrg
                             ? (1 / determinant) * (rgrg * jumps - grg * jumps_r)
                             : (1 / gg) * jumps;
  const Vec3<double> b = (1 / weight) * turns;
  const Vec3<double> along = rotate(turned, (1 / std::sqrt(dot(back, back))) * back),
                     left = cross(rotate(turned, Vec3<double>{0, 0, 1}), along);
  const double opened = std::max(0.0, dot(c, left));
  const double hoop = hoop_intensity(std::sqrt(opened * opened + bent * dot(b, b)), dot(c, along));
  return std::numbers::pi / 32 * hoop * hoop;
}

}  // namespace floe
