#include "geometry/joined_overlap.h"

#include <tuple>

#include "geometry/across.h"

namespace floe {

void JoinedOverlap::clear() {
  parts_.clear();
  corners_.clear();
  facets_.clear();
}

void JoinedOverlap::add(const Overlap& overlap, const FacetsOnB& facets) {
  parts_.push_back(overlap);
  std::size_t begin = 0;
  for (const std::size_t end : facets.end) {
    const std::size_t first = corners_.size();
    for (std::size_t k = begin; k < end; ++k) corners_.push_back(facets.corners[k]);
    facets_.push_back({.begin = first, .end = corners_.size(), .weight = 1});
    begin = end;
  }
}

void JoinedOverlap::leave_out(std::span<const Vec3<double>> corners) {
  const std::size_t first = corners_.size();
  corners_.insert(corners_.end(), corners.begin(), corners.end());
  facets_.push_back({.begin = first, .end = corners_.size(), .weight = -2});  // one of each part
}

Overlap JoinedOverlap::sum(bool with_patch) const {
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
Patch JoinedOverlap::patch(const Vec3<double>& n) const {
  const Vec3<double> apex = parts_[0].centroid;
  Patch sum;
  std::tie(sum.u, sum.v) = basis_across(n);
  const auto across = [&](const Vec3<double>& r) {
    return Across<double>{dot(sum.u, r), dot(sum.v, r)};
  };
  Vec3<double> first{};           // int r dA, from the apex
  double uu = 0, vv = 0, uv = 0;  // 12 times those about the apex
  for (const Facet& facet : facets_) {
    const Vec3<double> p = corners_[facet.begin] - apex;
    const Across<double> a = across(p);
    for (std::size_t k = facet.begin + 1; k + 1 < facet.end; ++k) {
      const Vec3<double> q = corners_[k] - apex, r = corners_[k + 1] - apex;
      const Across<double> b = across(q), c = across(r);
      const Across<double> s{a.u + b.u + c.u, a.v + b.v + c.v};
      const double area = 0.5 * facet.weight * length(cross(q - p, r - p));
      sum.area += area;
      first = first + area * (p + q + r);
      uu += area * (a.u * a.u + b.u * b.u + c.u * c.u + s.u * s.u);
      vv += area * (a.v * a.v + b.v * b.v + c.v * c.v + s.v * s.v);
      uv += area * (a.u * a.v + b.u * b.v + c.u * c.v + s.u * s.v);
    }
  }
  if (!(sum.area > 0)) return {};
  const Vec3<double> middle = (1 / (3 * sum.area)) * first;
  const Across<double> m = across(middle);
  sum.middle = apex + middle;
  sum.uu = uu / 12 - sum.area * m.u * m.u;
  sum.vv = vv / 12 - sum.area * m.v * m.v;
  sum.uv = uv / 12 - sum.area * m.u * m.v;
  for (const Edge& edge : whole_edges())
    sum.reach += reach_of_edge(across(edge.a - sum.middle), across(edge.b - sum.middle));
  return sum;
}

/// Returns the edges of all facets, those in one line and one plane as one edge: the quadrature of
/// reach_of_edge() would see where they are divided. Edges between facets and around common faces
/// are there in both directions and add up to nothing.
std::vector<JoinedOverlap::Edge> JoinedOverlap::whole_edges() const {
  constexpr double near = 1e-9;
  std::vector<Edge> edges;
  for (const Facet& facet : facets_) {
    if (facet.weight < 0) continue;
    Vec3<double> normal{};
    for (std::size_t k = facet.begin + 1; k + 1 < facet.end; ++k)
      normal = normal +
               cross(corners_[k] - corners_[facet.begin], corners_[k + 1] - corners_[facet.begin]);
    const double size = length(normal);
    if (size == 0) continue;
    for (std::size_t k = facet.begin; k < facet.end; ++k)
      edges.push_back({.a = corners_[k > facet.begin ? k - 1 : facet.end - 1],
                       .b = corners_[k],
                       .normal = (1 / size) * normal});
  }
  const auto continues = [&](const Edge& one, const Edge& next) {
    const Vec3<double> p = one.b - one.a, q = next.b - next.a;
    const double sizes = length(p) * length(q);
    return length(next.a - one.b) <= near * (length(p) + length(q)) &&
           length(next.normal - one.normal) < 1e-6 && dot(p, q) > 0 &&
           length(cross(p, q)) <= near * sizes;
  };
  for (bool found = true; found;) {
    found = false;
    for (std::size_t k = 0; k < edges.size(); ++k) {
      for (std::size_t m = 0; m < edges.size(); ++m) {
        if (m == k || !continues(edges[k], edges[m])) continue;
        edges[k].b = edges[m].b;
        edges.erase(edges.begin() + static_cast<std::ptrdiff_t>(m));
        if (m < k) --k;
        m = edges.size();
        found = true;
      }
    }
  }
  return edges;
}

}  // namespace floe
