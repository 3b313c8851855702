#include "geometry/joined_overlap.h"

#include "geometry/patch_sums.h"

namespace floe {

void JoinedOverlap::clear() {
  parts_.clear();
  corners_.clear();
  weights_.clear();
  edges_.clear();
}

void JoinedOverlap::add(const Overlap& overlap, const FacetsOnB& facets, const Triad<double>& axes,
                        const Vec3<double>& origin) {
  parts_.push_back(overlap);
  for (const Vec3<double>& r : facets.corners) corners_.push_back(origin + axes.to_world(r));
  weights_.resize(corners_.size() / 3, 1);
  for (const FacetsOnB::Edge& edge : facets.edges) {
    const Vec3<double> a = origin + axes.to_world(edge.a), b = origin + axes.to_world(edge.b);
    const double size = length(b - a);
    if (size > 0) edges_.push_back({a, b, (1 / size) * (b - a), size});
  }
}

void JoinedOverlap::leave_out(std::span<const Vec3<double>> corners) {
  for (std::size_t k = 1; k + 1 < corners.size(); ++k)
    corners_.insert(corners_.end(), {corners[0], corners[k], corners[k + 1]});
  weights_.resize(corners_.size() / 3, -2);  // one of each part
}

Overlap JoinedOverlap::sum(bool with_patch) {
  Overlap whole;
  Vec3<double> moment{};
  double size = 0;
  for (const Overlap& part : parts_) {
    whole.volume += part.volume;
    moment = moment + part.volume * part.centroid;
    whole.area = whole.area + part.area;
    size += length(part.area);
  }
  whole.centroid = (1 / whole.volume) * moment;
  constexpr double rounding = 1e-12;
  const double area = length(whole.area);
  if (area <= rounding * size) {
    whole.area = {};
    return whole;
  }
  for (const Overlap& part : parts_)
    whole.moment = whole.moment + part.moment + cross(part.centroid - whole.centroid, part.area);
  if (with_patch) whole.patch = patch((1 / area) * whole.area);
  return whole;
}

/// \param n  unit vector along S
Patch JoinedOverlap::patch(const Vec3<double>& n) {
  const Vec3<double> apex = parts_[0].centroid;
  PatchSums sums(n, apex);
  for (std::size_t k = 0; k < weights_.size(); ++k)
    sums.add(corners_[3 * k] - apex, corners_[3 * k + 1] - apex, corners_[3 * k + 2] - apex,
             weights_[k]);
  Patch sum = sums.patch();
  if (!(sum.area > 0)) return {};
  join_edges();
  for (const Edge& edge : edges_)
    sum.reach += reach_of_edge(sums.across(edge.a - sum.middle), sums.across(edge.b - sum.middle));
  return sum;
}

/// Makes edges that go on in one line one edge: the quadrature of reach_of_edge() would see where
/// they are divided. Edges around common faces are there in both directions, or go on in others
/// that are, and add up to nothing.
void JoinedOverlap::join_edges() {
  constexpr double near = 1e-9;
  const auto goes_on = [](const Edge& one, const Edge& next) {
    const Vec3<double> gap = next.a - one.b;
    const double reach = near * (one.length + next.length);
    return dot(gap, gap) <= reach * reach && length(next.along - one.along) <= near;
  };
  for (std::size_t k = 0; k < edges_.size(); ++k) {
    if (edges_[k].length == 0) continue;  // it is part of another edge
    for (std::size_t m = 0; m < edges_.size(); ++m) {
      if (m == k || edges_[m].length == 0 || !goes_on(edges_[k], edges_[m])) continue;
      edges_[k].b = edges_[m].b;
      edges_[k].length += edges_[m].length;
      edges_[m].length = 0;
      m = static_cast<std::size_t>(-1);  // look for what goes on from the new end
    }
  }
  std::erase_if(edges_, [](const Edge& edge) { return edge.length == 0; });
}

}  // namespace floe
