#include "geometry/facet_integrals.h"

#include <cmath>

#include "base/simd.h"
#include "geometry/across.h"

namespace floe {
namespace {

/// Returns x at one corner of each of `few_lanes` triples.
[[gnu::always_inline]] inline FewLanes gather(const double* x, const Triple* triples,
                                              std::uint8_t Triple::*corner) {
  return FewLanes([&](auto k) { return x[triples[k].*corner]; });
}

/// Returns one corner of each of `few_lanes` triangles, from the apex.
[[gnu::always_inline]] inline Vec3<FewLanes> corners(const Points& points, const Triple* triangles,
                                                     std::uint8_t Triple::*corner,
                                                     const Vec3<double>& apex) {
  return {gather(points.x.data(), triangles, corner) - apex.x,
          gather(points.y.data(), triangles, corner) - apex.y,
          gather(points.z.data(), triangles, corner) - apex.z};
}

/// Sums over the lanes.
struct VectorAndScalar {
  Vec3<double> vector;
  double scalar;
};
VectorAndScalar sums_of(const Vec3<FewLanes>& r, const FewLanes& s) {
  const Row sums = lane_sums(r.x, r.y, r.z, s);
  return {{sums[0], sums[1], sums[2]}, sums[3]};
}

Vec3<double> point(const Points& points, std::size_t slot) {
  return {points.x[slot], points.y[slot], points.z[slot]};
}

constexpr FewLanes::value_type zero = 0;
Vec3<FewLanes> zeros() { return {zero, zero, zero}; }

/// Sums over the triangles of the facets on B for Patch; r from the apex.
struct PatchSums {
  FewLanes area = zero;
  Vec3<FewLanes> first3 = zeros();                           ///< 3 int r |dA|
  Vec3<FewLanes> squares12 = zeros(), products12 = zeros();  ///< 12 int of xx, yy, zz; yz, zx, xy
};
/// Sums over triangles; r from the apex.
struct Sums {
  FewLanes volume6 = zero;
  Vec3<FewLanes> moment24 = zeros();
  Vec3<FewLanes> area2 = zeros(), moment6 = zeros();  ///< of the facets on B
  PatchSums patch;
};

/// Adds triangles with corners p, q, r and areas; s = p + q + r. A triangle has
/// int r r^T dA = (A/12) (p p^T + q q^T + r r^T + s s^T).
[[gnu::always_inline]] inline void add_to_patch(PatchSums& sums, const FewLanes& area,
                                                const Vec3<FewLanes>& p, const Vec3<FewLanes>& q,
                                                const Vec3<FewLanes>& r, const Vec3<FewLanes>& s) {
  const auto product = [&](FewLanes Vec3<FewLanes>::*a, FewLanes Vec3<FewLanes>::*b) {
    return area * ((p.*a * p.*b + q.*a * q.*b) + (r.*a * r.*b + s.*a * s.*b));
  };
  constexpr auto x = &Vec3<FewLanes>::x, y = &Vec3<FewLanes>::y, z = &Vec3<FewLanes>::z;
  sums.area += area;
  sums.first3 = sums.first3 + area * s;
  sums.squares12 = sums.squares12 + Vec3<FewLanes>{product(x, x), product(y, y), product(z, z)};
  sums.products12 = sums.products12 + Vec3<FewLanes>{product(y, z), product(z, x), product(x, y)};
}

/// Sums cones over the triangles, with a vertex of the overlap as apex, so that all numbers are as
/// small as the overlap.
Sums sum_triangles(const Points& points, const Facets& facets, bool with_patch) {
  const Vec3<double> apex = point(points, facets.apex);
  Sums sums;
  for (std::size_t k = 0; k < facets.triangles.size(); k += few_lanes) {
    const Triple* triangles = facets.triangles.data() + k;
    const Vec3<FewLanes> p = corners(points, triangles, &Triple::a, apex);
    const Vec3<FewLanes> q = corners(points, triangles, &Triple::b, apex);
    const Vec3<FewLanes> r = corners(points, triangles, &Triple::c, apex);
    const Vec3<FewLanes> twice = cross(q - p, r - p);
    const Vec3<FewLanes> sum = p + q + r;
    const FewLanes v = dot(p, twice);
    sums.volume6 += v;
    sums.moment24 = sums.moment24 + v * sum;
    if (k >= facets.on_b) continue;
    sums.area2 = sums.area2 + twice;
    sums.moment6 = sums.moment6 + cross(sum, twice);
    if (with_patch) add_to_patch(sums.patch, 0.5 * length(twice), p, q, r, sum);
  }
  return sums;
}

/// The vertices across S.
struct VerticesAcross {
  alignas(64) std::array<double, Points::low> u, v;
};

/// Sums along the rim of the facets on B. An edge between two of these facets is in both, once in
/// each direction, and so adds nothing.
double sum_reach(const Facets& facets, const VerticesAcross& vertices,
                 const Across<double>& middle) {
  FewLanes reach = zero;
  for (std::size_t k = 0; k < facets.rim.size(); k += few_lanes) {
    const Triple* edges = facets.rim.data() + k;
    const auto across = [&](std::uint8_t Triple::*end) {
      return Across<FewLanes>{gather(vertices.u.data(), edges, end) - middle.u,
                              gather(vertices.v.data(), edges, end) - middle.v};
    };
    reach += reach_of_edge(across(&Triple::a), across(&Triple::b));
  }
  return std::experimental::reduce(reach);
}

/// \param n  unit vector along S
void set_patch(Patch& patch, const Points& points, const Facets& facets, const Vec3<double>& n,
               const PatchSums& sums) {
  const auto [first3, area] = sums_of(sums.first3, sums.area);
  if (!(area > 0)) return;
  const auto [u, v] = basis_across(n);
  const Vec3<double> apex = point(points, facets.apex);
  VerticesAcross across;
  for (std::size_t k = 0; k < facets.slots; k += few_lanes) {
    const Vec3<FewLanes> r{load_few(points.x.data() + k) - apex.x,
                           load_few(points.y.data() + k) - apex.y,
                           load_few(points.z.data() + k) - apex.z};
    dot(u, r).copy_to(across.u.data() + k, std::experimental::vector_aligned);
    dot(v, r).copy_to(across.v.data() + k, std::experimental::vector_aligned);
  }
  const Vec3<double> squares = sums_of(sums.squares12, zero).vector,
                     products = sums_of(sums.products12, zero).vector;
  const Vec3<double> middle = (1 / (3 * area)) * first3;
  const Across<double> m{dot(u, middle), dot(v, middle)};
  /// The second moments about the apex on a vector.
  const auto moments = [&](const Vec3<double>& w) {
    return Vec3<double>{squares.x * w.x + products.z * w.y + products.y * w.z,
                        products.z * w.x + squares.y * w.y + products.x * w.z,
                        products.y * w.x + products.x * w.y + squares.z * w.z};
  };
  const Vec3<double> of_u = moments(u), of_v = moments(v);
  patch.area = area;
  patch.middle = apex + middle;
  patch.u = u;
  patch.v = v;
  patch.uu = (1.0 / 12) * dot(u, of_u) - area * m.u * m.u;
  patch.vv = (1.0 / 12) * dot(v, of_v) - area * m.v * m.v;
  patch.uv = (1.0 / 12) * dot(u, of_v) - area * m.u * m.v;
  patch.reach = sum_reach(facets, across, m);
}

}  // namespace

void set_integrals(Overlap& o, const Points& points, const Facets& facets, bool with_patch) {
  const Sums sums = sum_triangles(points, facets, with_patch);
  const auto [moment24, volume6] = sums_of(sums.moment24, sums.volume6);
  if (!(volume6 > 0)) return;
  o.volume = (1.0 / 6) * volume6;
  const Vec3<double> c = (0.25 / volume6) * moment24;
  o.centroid = point(points, facets.apex) + c;
  o.area = 0.5 * sums_of(sums.area2, zero).vector;
  o.moment = (1.0 / 6) * sums_of(sums.moment6, zero).vector - cross(c, o.area);
  const double area = length(o.area);
  if (with_patch && area > 0) set_patch(o.patch, points, facets, (1 / area) * o.area, sums.patch);
}

}  // namespace floe
