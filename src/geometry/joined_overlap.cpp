#include "geometry/joined_overlap.h"

#include <tuple>

#include "geometry/across.h"

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

/// Sums over triangles as Clipper::patch() does. \param n  unit vector along S
Patch JoinedOverlap::patch(const Vec3<double>& n) {
  const Vec3<double> apex = parts_[0].centroid;
  Patch sum;
  std::tie(sum.u, sum.v) = basis_across(n);
  const auto across = [&](const Vec3<double>& r) {
    return Across<double>{dot(sum.u, r), dot(sum.v, r)};
  };
  Vec3<double> first{};           // int r dA, from the apex
  double uu = 0, vv = 0, uv = 0;  // 12 times those about the apex
  for (std::size_t k = 0; k < weights_.size(); ++k) {
    const Vec3<double> p = corners_[3 * k] - apex, q = corners_[3 * k + 1] - apex,
                       r = corners_[3 * k + 2] - apex;
    const Across<double> a = across(p), b = across(q), c = across(r);
    const Across<double> s{a.u + b.u + c.u, a.v + b.v + c.v};
    const double area = 0.5 * weights_[k] * length(cross(q - p, r - p));
    sum.area += area;
    first = first + area * (p + q + r);
    uu += area * (a.u * a.u + b.u * b.u + c.u * c.u + s.u * s.u);
    vv += area * (a.v * a.v + b.v * b.v + c.v * c.v + s.v * s.v);
    uv += area * (a.u * a.v + b.u * b.v + c.u * c.v + s.u * s.v);
  }
  if (!(sum.area > 0)) return {};
  const Vec3<double> middle = (1 / (3 * sum.area)) * first;
  const Across<double> m = across(middle);
  sum.middle = apex + middle;
  sum.uu = uu / 12 - sum.area * m.u * m.u;
  sum.vv = vv / 12 - sum.area * m.v * m.v;
  sum.uv = uv / 12 - sum.area * m.u * m.v;
  join_edges();
  for (const Edge& edge : edges_)
    sum.reach += reach_of_edge(across(edge.a - sum.middle), across(edge.b - sum.middle));
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
    for (std::size_t m = 0; m < edges_.size(); ++m) {
      if (m == k || !goes_on(edges_[k], edges_[m])) continue;
      edges_[k].b = edges_[m].b;
      edges_[k].length += edges_[m].length;
      edges_[m] = edges_.back();
      edges_.pop_back();
      if (k == edges_.size()) k = m;     // the edge itself was the last one, and is there now
      m = static_cast<std::size_t>(-1);  // look for what goes on from its new end
    }
  }
}

}  // namespace floe
