#include "contact/narrow_phase.h"

#include <algorithm>
#include <limits>

#include "geometry/separation.h"

namespace floe {
namespace {

/// Gaps below this part of the radius of a body, and overlaps below this part of its cube, are
/// rounding.
constexpr double rounding = 1e-13, rounding_volume = 1e-15;

/// Places vertices in another frame.
/// \param axes, x      axes and origin of the frame of the vertices in the other frame
/// \param[out] placed  in the other frame
void place(std::span<const Vec3<double>> vertices, const Triad<double>& axes, const Vec3<double>& x,
           std::vector<Vec3<double>>& placed) {
  placed.clear();
  for (const Vec3<double>& r : vertices) placed.push_back(x + axes.to_world(r));
}

void to_world(Patch& p, const Triad<double>& axes, const Vec3<double>& origin) {
  p.middle = axes.to_world(p.middle) + origin;
  p.u = axes.to_world(p.u);
  p.v = axes.to_world(p.v);
}

}  // namespace

Reaches reaches(const Solids& solids, const Pair& pair, const Placed& a, const Placed& b,
                const Vec3<double>& axis) {
  const Vec3<double> along_a = a.axes.to_local(axis), along_b = b.axes.to_local(axis);
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const Vec3<double>& r : solids.vertices(pair.a)) low = std::min(low, dot(along_a, r));
  for (const Vec3<double>& r : solids.vertices(pair.b)) high = std::max(high, dot(along_b, r));
  if (solids.is_half_space(pair.b)) high = solids.planes(pair.b)[0].offset;
  return {.low_of_a = low, .high_of_b = high};
}

double NarrowPhase::gap(const Solids& solids, Pair& pair, const Placed& a, const Placed& b,
                        int tries) {
  const Vec3<double> apart = a.x - b.x;
  const auto [low, high] = reaches(solids, pair, a, b, pair.axis);
  const double found = low + dot(pair.axis, apart) - high;
  if (found > 0 || tries == 0 || solids.is_half_space(pair.b)) return found;
  place(solids.vertices(pair.a), a.axes, apart, vertices_a_);
  vertices_b_.clear();
  for (const Vec3<double>& r : solids.vertices(pair.b)) vertices_b_.push_back(b.axes.to_world(r));
  return separate(vertices_a_, vertices_b_, pair.axis, tries);
}

bool NarrowPhase::has_gap(const Solids& solids, Pair& pair, const Placed& a, const Placed& b) {
  constexpr int tries = 8;
  constexpr double margin = 1e-6;  // for the rounding of travels
  const double found = gap(solids, pair, a, b, tries);
  if (!(found > rounding * solids.radius(pair.a))) return false;
  pair.safe = (a.travelled + b.travelled) + (1 - margin) * found;
  return true;
}

CutRecord& NarrowPhase::record_of(Pair& pair) {
  if (pair.cuts < 0) {
    pair.cuts = static_cast<std::int32_t>(records_.size());
    records_.emplace_back();
  }
  return item(records_, pair.cuts);
}

/// Sets the overlap in the frame of B.
/// \param turn, x  axes and place of A in this frame
/// \param found    zeros
void NarrowPhase::clip(const Solids& solids, Pair& pair, const Triad<double>& turn,
                       const Vec3<double>& x, const FurtherPlanes& further, Overlap& found) {
  const std::span<const HalfSpace> planes = solids.planes(pair.b);
  if (const EdgeGraph* graph = solids.graph(pair.a)) {
    graph_clipper_.place(solids.vertex_lists(pair.a), turn, x);
    if (graph_clipper_.overlap(*graph, planes, with_patch_, further, record_of(pair), found)) return;
  }
  place(solids.vertices(pair.a), turn, x, vertices_a_);
  found = clipper_.overlap(solids.shapes(), pair.a, vertices_a_, planes, with_patch_, further);
}

PairOverlap NarrowPhase::overlap(const Solids& solids, const Wear& wear, Pair& pair,
                                 const Placed& a, const Placed& b) {
  const Triad<double> turn{b.axes.to_local(a.axes.e1), b.axes.to_local(a.axes.e2),
                           b.axes.to_local(a.axes.e3)};
  const Vec3<double> x = b.axes.to_local(a.x - b.x);
  worn_.clear();
  for (const HalfSpace& left : wear.of(pair.a)) {
    const Vec3<double> normal = turn.to_world(left.normal);
    worn_.push_back({normal, left.offset + dot(normal, x)});
  }
  PairOverlap met;
  Overlap& o = met.overlap;
  clip(solids, pair, turn, x, {.a = worn_, .b = wear.of(pair.b)}, o);
  const double radius = solids.radius(pair.a);
  if (o.volume <= rounding_volume * radius * radius * radius) {
    o.volume = 0;
    return met;
  }
  const HalfSpace& face = solids.planes(pair.b)[0];
  met.depth = face.offset - dot(face.normal, o.centroid);
  o.centroid = b.axes.to_world(o.centroid) + (b.x - a.x);
  o.area = b.axes.to_world(o.area);
  o.moment = b.axes.to_world(o.moment);
  if (with_patch_) to_world(o.patch, b.axes, b.x - a.x);
  return met;
}

}  // namespace floe
