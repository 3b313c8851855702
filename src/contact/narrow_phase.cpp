#include "contact/narrow_phase.h"

#include <algorithm>
#include <tuple>
#include <utility>

#include "geometry/separation.h"

namespace floe {
namespace {

/// Places vertices in another frame.
/// \param axes, x      axes and origin of the frame of the vertices in the other frame
/// \param[out] placed  in the other frame
void place(std::span<const Vec3<double>> vertices, const Triad<double>& axes, const Vec3<double>& x,
           std::vector<Vec3<double>>& placed) {
  placed.clear();
  for (const Vec3<double>& r : vertices) placed.push_back(x + axes.to_world(r));
}

/// The gaps of a pair at the planes of its faces. A face is a plane of B, or, counted on, of A.
class Faces {
 public:
  Faces(const Solids& solids, const Pair& pair, const Placed& a, const Placed& b)
      : planes_a_(solids.planes(pair.a)),
        planes_b_(solids.planes(pair.b)),
        vertices_a_(solids.vertex_lists(pair.a)),
        vertices_b_(solids.vertex_lists(pair.b)),
        place_(a, b) {}

  /// Returns the gap between the plane of a face and the vertices of the other body [m].
  double gap(std::int32_t face) const {
    const auto k = static_cast<std::size_t>(face);
    return k < planes_b_.size() ? gap_at_b(planes_b_[k])
                                : gap_at_a(planes_a_[k - planes_b_.size()]);
  }
  /// Returns the face with the widest gap above `least`, and this gap; else -1.
  std::pair<std::int16_t, double> widest(double least) const;

 private:
  /// The height of the other body's origin above a plane: no gap is wider if the origin is inside.
  double height_at_b(const HalfSpace& plane) const {
    return dot(plane.normal, place_.x) - plane.offset;
  }
  double height_at_a(const HalfSpace& plane) const {
    return -dot(place_.turn.to_world(plane.normal), place_.x) - plane.offset;
  }
  double gap_at_b(const HalfSpace& plane) const {
    return height_at_b(plane) + lowest_along(vertices_a_, place_.turn.to_local(plane.normal));
  }
  double gap_at_a(const HalfSpace& plane) const {
    return height_at_a(plane) + lowest_along(vertices_b_, place_.turn.to_world(plane.normal));
  }

  std::span<const HalfSpace> planes_a_, planes_b_;
  VertexLists vertices_a_, vertices_b_;
  Relative place_;
};

std::pair<std::int16_t, double> Faces::widest(double least) const {
  std::pair<std::int16_t, double> found{-1, least};
  std::int16_t face = 0;
  const auto look = [&](double height, double (Faces::*gap_at)(const HalfSpace&) const,
                        const HalfSpace& plane) {
    if (height > found.second) {
      const double width = (this->*gap_at)(plane);
      if (width > found.second) found = {face, width};
    }
    ++face;
  };
  for (const HalfSpace& plane : planes_b_) look(height_at_b(plane), &Faces::gap_at_b, plane);
  if (vertices_b_.number == 0) return found;  // a half-space
  for (const HalfSpace& plane : planes_a_) look(height_at_a(plane), &Faces::gap_at_a, plane);
  return found;
}

double gap_along_axis(const Solids& solids, const Pair& pair, const Placed& a, const Placed& b) {
  const auto [low, high] = reaches(solids, pair, a, b, pair.axis);
  return low + dot(pair.axis, a.x - b.x) - high;
}

}  // namespace

Reaches reaches(const Solids& solids, const Pair& pair, const Placed& a, const Placed& b,
                const Vec3<double>& axis) {
  const Vec3<double> along_a = a.axes.to_local(axis), along_b = b.axes.to_local(axis);
  return {.low_of_a = lowest_along(solids.vertex_lists(pair.a), along_a),
          .high_of_b = solids.is_half_space(pair.b)
                           ? solids.planes(pair.b)[0].offset
                           : -lowest_along(solids.vertex_lists(pair.b), -along_b)};
}

/// Looks first where the pair was separated last, then at the faces, which separate most pairs that
/// nearly touch, then for an axis between edges.
double NarrowPhase::gap(const Solids& solids, Pair& pair, const Placed& a, const Placed& b,
                        double enough, int tries) {
  double last = pair.face < 0 ? gap_along_axis(solids, pair, a, b) : 0;
  if (last > enough) return last;
  const Faces faces(solids, pair, a, b);
  if (pair.face >= 0) last = faces.gap(pair.face);
  if (last > enough) return last;
  const auto [face, width] = faces.widest(std::max(last, 0.0));
  if (face >= 0) {
    pair.face = face;
    return width;
  }
  if (last > 0 || solids.is_half_space(pair.b)) return last;
  pair.face = -1;
  place(solids.vertices(pair.a), a.axes, a.x - b.x, vertices_a_);
  vertices_b_.clear();
  for (const Vec3<double>& r : solids.vertices(pair.b)) vertices_b_.push_back(b.axes.to_world(r));
  return separate(vertices_a_, vertices_b_, pair.axis, tries);
}

bool NarrowPhase::has_gap(const Solids& solids, Pair& pair, const Placed& a, const Placed& b) {
  constexpr int tries = 8;
  constexpr double margin = 1e-6;  // for the rounding of travels
  const double least = rounding_of_gaps * solids.radius(pair.a);
  const double found = gap(solids, pair, a, b, least, tries);
  if (!(found > least)) return false;
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
    by_graph_ =
        graph_clipper_.overlap(*graph, planes, with_patch_, further, record_of(pair), found);
    if (by_graph_) return;
  }
  by_graph_ = false;
  place(solids.vertices(pair.a), turn, x, vertices_a_);
  found = clipper_.overlap(solids.shapes_with(pair.a), solids.shape_number(pair.a), vertices_a_,
                           planes, with_patch_, further);
}

void NarrowPhase::facets_on_b(const Pair& pair, FacetsOnB& facets) const {
  if (by_graph_) {
    graph_clipper_.facets_on_b(item(records_, pair.cuts), facets);
  } else {
    clipper_.facets_on_b(facets);
  }
}

void NarrowPhase::overlap(const Solids& solids, const Wear& wear, Pair& pair, const Placed& a,
                          const Placed& b, PairOverlap& met) {
  const auto [turn, x] = Relative(a, b);
  worn_.clear();
  for (const HalfSpace& left : wear.of(pair.a)) worn_.push_back(placed(left, turn, x));
  met = {};
  clip(solids, pair, turn, x, {.a = worn_, .b = wear.of(pair.b)}, met.overlap);
  take_to_world(met, solids.planes(pair.b)[0], solids.radius(pair.a), a, b, with_patch_);
}

}  // namespace floe
